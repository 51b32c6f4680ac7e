#include "study/campaign_result.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "study/pareto.h"

namespace culprit::study {

void Summary::add(const std::vector<double>& values, bool is_censored, const Weights& weights) {
  if (values.empty()) return;
  for (const double value : values) {
    moments_.add(value);
    if (!is_censored) distribution_.add(value);
  }
  if (is_censored) censored_ += static_cast<std::int64_t>(values.size());
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  clusters_.add(sum, static_cast<double>(values.size()));
  bootstrap_.add(weights, sum, static_cast<double>(values.size()));
}

const Row* CampaignResult::find(const Configuration& configuration) const {
  const auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& candidate) {
    return candidate.configuration == configuration;
  });
  return row == rows.end() ? nullptr : &*row;
}

std::vector<std::optional<bool>> on_front(const CampaignResult& result) {
  std::map<std::pair<std::string, Probabilities>, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < result.rows.size(); ++i) {
    const Configuration& row = result.rows[i].configuration;
    if (row.planner != "oracle") groups[{row.profile, row.probabilities}].push_back(i);
  }
  std::vector<std::optional<bool>> is_on(result.rows.size());
  for (const auto& [of, members] : groups) {
    std::vector<std::vector<double>> costs;
    for (const std::size_t i : members) {
      auto& own = costs.emplace_back();
      for (const Metric metric : kHonestCosts) own.push_back(result.rows[i][metric].mean());
    }
    const std::vector<bool> front = pareto_front(costs);
    for (std::size_t m = 0; m < members.size(); ++m) is_on[members[m]] = front[m];
  }
  return is_on;
}

CampaignFold::CampaignFold(Campaign campaign) {
  for (const Configuration& configuration : campaign.rows)
    result_.rows.emplace_back().configuration = configuration;
  result_.campaign = std::move(campaign);
}

void CampaignFold::add(const RunMetrics& run) {
  const Campaign& campaign = result_.campaign;
  const RunId id = campaign[next_++];
  Row& row = result_.rows[id.row];
  ++row.runs;
  const Weights weights = poisson_weights(campaign.seed, id.row, id.run);
  for (std::size_t i = 0; i < kMetricCount; ++i) {
    const auto metric = static_cast<Metric>(i);
    const bool is_censored = metric == Metric::kRecovery && run.honest.is_recovery_censored;
    row.metrics[i].add(values_of(run, metric), is_censored, weights);
  }
}

}  // namespace culprit::study
