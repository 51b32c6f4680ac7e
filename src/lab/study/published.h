// The published results of the paper's SUNSET evaluation, as data, to be compared with our
// measurements.
//
// Means and standard deviations are over 162 runs for each configuration; the deviation is the
// population's (the exemplar's script uses numpy's default). Reaction times are pooled over the
// runs, and how many there were is not printed.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "study/campaign.h"
#include "study/metric.h"
#include "study/statistics/moments.h"

namespace culprit::study::published {

inline constexpr int kRuns = 162;

struct MeanSd {
  double mean = 0;
  double sd = 0;
};

// As a sample of kRuns. The printed deviations are the population's.
Moments sample(const MeanSd& value);

using Values = std::array<MeanSd, kPublishedMetrics.size()>;  // in the order of kPublishedMetrics

struct Result {
  PaperSwitches switches;
  Probabilities probabilities = Probabilities::kIdeal;
  Values values;
};

// Table "Results of Ablation Study" (tab:ablation-study), in its order of rows.
std::span<const Result, 8> ablation();

// Table "Results of robustness analysis" (tab:robustness test): ideal, misspecified. The first is
// the ablation's last row.
std::span<const Result, 2> robustness();

// The paper's values for a configuration: it played its own planner. Empty if it has none.
std::optional<Values> values_of(const Configuration& configuration);

// The colours of the second ablation table: grey, green, red.
enum class Significance : std::uint8_t { kNotSignificant, kBetter, kWorse };

struct Change {
  double percent = 0;  // of the first configuration's mean
  Significance significance = Significance::kNotSignificant;
};

enum class Factor : std::uint8_t { kDependencies, kCriticality, kImpact };

// The effect of switching on one factor of a configuration.
struct Effect {
  Factor factor = Factor::kDependencies;
  PaperSwitches without;
  PaperSwitches with;
  std::array<Change, kPublishedMetrics.size()> changes;
};

// Table "Evaluation of the ablation study" (tab:ablation-study-eval): ANOVA with pairwise t-tests
// and Tukey's correction at 95 %; in its order of rows.
std::span<const Effect, 12> effects();

// Section "Learning mechanism". Its result is a figure (fig:learning-result) without numbers: the
// learned probabilities of F1 and F4 converge to the true rates.
struct Learning {
  double confidence;       // c_p
  double misspecified_by;  // share of the ideal probability
  int faults;              // that were introduced
  int failures;            // that they caused
};
inline constexpr Learning kLearning = {10, 0.2, 180, 257};

}  // namespace culprit::study::published
