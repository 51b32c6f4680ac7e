#include "study/metric.h"

namespace culprit::study {
namespace {

// In the order of Metric.
constexpr std::array<MetricTraits, kMetricCount> kTraits = {{
    {"ratio", "resolved / executed", R"($\frac{f_\text{resolved}}{s_\text{executed}}$)",
     Better::kHigher},
    {"reaction_s", "reaction [s]", R"($t_\text{react}$[s])", Better::kLower},
    {"downtime_s", "downtime [s]", R"($t_\text{down}$[s])", Better::kLower},
    {"unnecessary_redeployments", "unnecessary redeployments", R"($\text{\#rdply}_\text{u}$)",
     Better::kLower},
    {"honest_downtime_s", "honest downtime [s]", R"($t_\text{down}^\text{honest}$[s])",
     Better::kLower},
    {"strategies_per_fault", "strategies per fault", R"($s_\text{executed}$ per fault)",
     Better::kLower},
    {"wrong_component", "wrong component", "wrong component", Better::kLower},
    {"unresolved", "unresolved failures", "unresolved", Better::kLower},
    {"recovery_s", "recovery [s]", R"($t_\text{recover}$[s])", Better::kLower},
    {"root_cause_top1", "root cause top-1", "top-1", Better::kHigher},
    {"root_cause_exact", "root causes exact", "exact", Better::kHigher},
}};

std::vector<double> share(std::int32_t part, std::int32_t whole) {
  if (whole == 0) return {};
  return {static_cast<double>(part) / whole};
}

}  // namespace

const MetricTraits& traits(Metric metric) { return kTraits[static_cast<std::size_t>(metric)]; }

std::vector<double> values_of(const RunMetrics& run, Metric metric) {
  const HonestMetrics& honest = run.honest;
  switch (metric) {
    case Metric::kRatio:
      if (run.is_left_out) return {};
      return {run.ratio};
    case Metric::kReaction:
      if (run.is_left_out) return {};
      return run.reactions_s;
    case Metric::kDowntime:
      if (run.is_left_out) return {};
      return {run.downtime_s};
    case Metric::kUnnecessaryRedeployments:
      return {static_cast<double>(run.unnecessary_redeployments)};
    case Metric::kHonestDowntime:
      return {honest.downtime_s};
    case Metric::kStrategiesPerFault:
      return share(honest.strategies, honest.faults);
    case Metric::kWrongComponent:
      return {static_cast<double>(honest.wrong_component)};
    case Metric::kUnresolved:
      return {static_cast<double>(honest.unresolved)};
    case Metric::kRecovery:
      return {honest.recovery_s};
    case Metric::kTopCauseRight:
      return share(honest.root_causes.top_right, honest.root_causes.asked);
    case Metric::kExactCausesRight:
      return share(honest.root_causes.exact_right, honest.root_causes.asked);
  }
  return {};
}

}  // namespace culprit::study
