// The metrics of a study: the paper's four, and the honest ones beside them.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "study/run_metrics.h"

namespace culprit::study {

enum class Metric : std::uint8_t {
  kRatio,
  kReaction,
  kDowntime,
  kUnnecessaryRedeployments,
  kHonestDowntime,
  kStrategiesPerFault,
  kWrongComponent,
  kUnresolved,
  kRecovery,
  kTopCauseRight,
  kExactCausesRight
};

inline constexpr std::array kPublishedMetrics = {
    Metric::kRatio, Metric::kReaction, Metric::kDowntime, Metric::kUnnecessaryRedeployments};
inline constexpr std::array kHonestMetrics = {Metric::kHonestDowntime,  Metric::kStrategiesPerFault,
                                              Metric::kWrongComponent,  Metric::kUnresolved,
                                              Metric::kRecovery,        Metric::kTopCauseRight,
                                              Metric::kExactCausesRight};
// The honest metrics that are costs of managing, of which the Pareto front consists.
inline constexpr std::array kHonestCosts = {Metric::kHonestDowntime, Metric::kStrategiesPerFault,
                                            Metric::kWrongComponent, Metric::kUnresolved,
                                            Metric::kRecovery};
inline constexpr std::size_t kMetricCount = kPublishedMetrics.size() + kHonestMetrics.size();

enum class Better : std::uint8_t { kHigher, kLower };

struct MetricTraits {
  std::string_view key;    // in JSON and CSV; its end tells the unit
  std::string_view title;  // short, for the head of a column, with the unit
  std::string_view latex;  // the same as the paper prints it
  Better better;
};

const MetricTraits& traits(Metric metric);

// The values that a run adds to a metric: none, one, or, of reaction times, any number.
std::vector<double> values_of(const RunMetrics& run, Metric metric);

}  // namespace culprit::study
