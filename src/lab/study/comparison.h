// Ours beside the paper's: each mean, and each effect of switching a factor on.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "study/campaign_result.h"
#include "study/published.h"
#include "study/statistics/anova.h"

namespace culprit::study {

// One of our means beside the paper's.
struct MeanComparison {
  const Row* row = nullptr;
  Metric metric = Metric::kRatio;
  published::MeanSd theirs;
  bool is_within = false;  // our mean lies in their mean +- 1 sd
};

// The paper's four metrics; empty if it does not have the row's configuration. Points to `row`.
std::vector<MeanComparison> compare_means(const Row& row);

// How switching a factor on changes a mean, tested as the paper does it.
struct Change {
  std::optional<double> percent;  // of the mean without; nothing where that is 0
  Difference difference;          // Tukey's HSD among the eight configurations
  published::Significance significance = published::Significance::kNotSignificant;
  published::Change theirs;

  // Both rise, or both fall.
  bool has_same_sign() const { return (difference.estimate > 0) == (theirs.percent > 0); }
  bool is_significant_for_them() const {
    return theirs.significance != published::Significance::kNotSignificant;
  }
};

struct Effect {
  const published::Effect* published = nullptr;
  std::array<Change, kPublishedMetrics.size()> changes;
};

// The eight configurations of one planner in one profile. Points into a CampaignResult.
struct Ablation {
  std::string planner;
  std::string profile;
  std::vector<MeanComparison> means;  // by row and metric, both in the paper's order
  std::vector<Effect> effects;        // in the paper's order
  std::array<std::optional<Anova>, kPublishedMetrics.size()> anovas;
};

// One for each planner and profile of which all eight configurations with ideal probabilities are
// there.
std::vector<Ablation> ablations(const CampaignResult& result);

// How well an ablation agrees with the paper's, counted.
struct Agreement {
  int means = 0;
  int means_within = 0;
  int effects = 0;
  int same_significance = 0;  // not significant for both, or significant for both, the same way
  int significant = 0;        // for them
  int significant_signs = 0;  // of these, ours has the same sign
};

Agreement agreement(const Ablation& ablation);

}  // namespace culprit::study
