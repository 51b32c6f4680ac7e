// The result of a campaign: each metric of each configuration, in memory that does not grow with
// the number of runs.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "study/campaign.h"
#include "study/metric.h"
#include "study/statistics/bootstrap.h"
#include "study/statistics/clusters.h"
#include "study/statistics/distribution.h"
#include "study/statistics/moments.h"

namespace culprit::study {

// A metric over the runs of a configuration.
class Summary {
 public:
  // Adds the values of one run. `is_censored`: the values are lower bounds.
  void add(const std::vector<double>& values, bool is_censored, const Weights& weights);

  std::int64_t count() const { return moments_.count(); }
  double mean() const { return moments_.mean(); }
  // The population's, as in the paper's tables.
  double sd() const { return moments_.population_sd(); }
  const Moments& moments() const { return moments_; }
  // For tests: as of so many independent values, since those of one run are not.
  Moments independent() const { return clusters_.independent(moments_); }
  // 95 % interval of the mean, by bootstrap over runs; empty for too few runs.
  std::optional<Interval> interval() const { return bootstrap_.interval(); }
  // Values that are lower bounds. They are in the mean, which is a lower bound then too, and, where
  // all runs end at the same time, the mean restricted to that time.
  std::int64_t censored() const { return censored_; }
  // Without those that are censored.
  const Distribution& distribution() const { return distribution_; }

 private:
  Moments moments_;
  Clusters clusters_;  // the runs
  BootstrapMean bootstrap_;
  Distribution distribution_;
  std::int64_t censored_ = 0;
};

struct Row {
  Configuration configuration;
  std::int64_t runs = 0;
  std::array<Summary, kMetricCount> metrics;

  const Summary& operator[](Metric metric) const {
    return metrics[static_cast<std::size_t>(metric)];
  }
};

struct CampaignResult {
  Campaign campaign;
  std::vector<Row> rows;  // as in the campaign

  // Null if there is none.
  const Row* find(const Configuration& configuration) const;
};

// Which rows no other beats in the means of all honest costs, among those of the same profile and
// probabilities (study/pareto.h). Empty for the oracle, which is a bound and no planner.
std::vector<std::optional<bool>> on_front(const CampaignResult& result);

// Folds runs into a result.
class CampaignFold {
 public:
  explicit CampaignFold(Campaign campaign);

  // The next run in the campaign's order. @pre !is_complete()
  void add(const RunMetrics& run);

  std::uint64_t size() const { return next_; }
  bool is_complete() const { return next_ == result_.campaign.size(); }

  // The result so far.
  CampaignResult result() && { return std::move(result_); }
  const CampaignResult& result() const& { return result_; }

 private:
  CampaignResult result_;
  std::uint64_t next_ = 0;
};

}  // namespace culprit::study
