#include "study/comparison.h"

#include <algorithm>
#include <cmath>

namespace culprit::study {
namespace {

constexpr double kAlpha = 0.05;

using Rows = std::array<const Row*, 8>;

// The rows of the planner and profile of `like`, in the paper's order; null where one is missing.
Rows ablation_rows(const CampaignResult& result, const Configuration& like) {
  Rows rows{};
  const auto published = published::ablation();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i] = result.find(
        {published[i].switches, like.planner, like.profile, published[i].probabilities});
  }
  return rows;
}

std::size_t index_of(const PaperSwitches& switches) {
  const auto rows = published::ablation();
  const auto row =
      std::find_if(rows.begin(), rows.end(), [&](const auto& r) { return r.switches == switches; });
  return static_cast<std::size_t>(row - rows.begin());
}

published::Significance significance(const Difference& difference, Metric metric) {
  if (difference.p >= kAlpha) return published::Significance::kNotSignificant;
  const bool is_better = (difference.estimate > 0) == (traits(metric).better == Better::kHigher);
  return is_better ? published::Significance::kBetter : published::Significance::kWorse;
}

Change change(const Rows& rows, const published::Effect& effect, std::size_t metric_index,
              const TukeyHsd* tukey) {
  const Metric metric = kPublishedMetrics[metric_index];
  const std::size_t without = index_of(effect.without);
  const std::size_t with = index_of(effect.with);
  const double base = (*rows[without])[metric].mean();
  Change change;
  change.theirs = effect.changes[metric_index];
  change.difference.estimate = (*rows[with])[metric].mean() - base;
  if (base != 0) change.percent = change.difference.estimate / base * 100;
  if (tukey == nullptr) return change;
  change.difference = tukey->compare(without, with);
  change.significance = significance(change.difference, metric);
  return change;
}

Ablation ablation(const Rows& rows) {
  Ablation ablation;
  ablation.planner = rows[0]->configuration.planner;
  ablation.profile = rows[0]->configuration.profile;
  for (const Row* row : rows)
    for (const MeanComparison& mean : compare_means(*row)) ablation.means.push_back(mean);
  for (const published::Effect& effect : published::effects())
    ablation.effects.push_back({&effect, {}});
  for (std::size_t i = 0; i < kPublishedMetrics.size(); ++i) {
    std::vector<Moments> groups;
    for (const Row* row : rows) groups.push_back((*row)[kPublishedMetrics[i]].moments());
    const std::optional<TukeyHsd> tukey = TukeyHsd::of(std::move(groups), kAlpha);
    if (tukey) ablation.anovas[i] = tukey->anova();
    for (Effect& effect : ablation.effects)
      effect.changes[i] = change(rows, *effect.published, i, tukey ? &*tukey : nullptr);
  }
  return ablation;
}

}  // namespace

std::vector<MeanComparison> compare_means(const Row& row) {
  const auto published = published::values_of(row.configuration);
  if (!published) return {};
  std::vector<MeanComparison> comparisons;
  for (std::size_t i = 0; i < kPublishedMetrics.size(); ++i) {
    const published::MeanSd& theirs = (*published)[i];
    const Summary& ours = row[kPublishedMetrics[i]];
    const bool is_within = ours.count() > 0 && std::abs(ours.mean() - theirs.mean) <= theirs.sd;
    comparisons.push_back({&row, kPublishedMetrics[i], theirs, is_within});
  }
  return comparisons;
}

std::vector<Ablation> ablations(const CampaignResult& result) {
  std::vector<Ablation> found;
  for (const Row& row : result.rows) {
    const Rows rows = ablation_rows(result, row.configuration);
    const bool is_complete = std::find(rows.begin(), rows.end(), nullptr) == rows.end();
    if (is_complete && rows[0] == &row) found.push_back(ablation(rows));
  }
  return found;
}

Agreement agreement(const Ablation& ablation) {
  Agreement count;
  for (const MeanComparison& mean : ablation.means) {
    ++count.means;
    if (mean.is_within) ++count.means_within;
  }
  for (const Effect& effect : ablation.effects) {
    for (const Change& change : effect.changes) {
      ++count.effects;
      if (change.significance == change.theirs.significance) ++count.same_significance;
      if (!change.is_significant_for_them()) continue;
      ++count.significant;
      if (change.has_same_sign()) ++count.significant_signs;
    }
  }
  return count;
}

}  // namespace culprit::study
