#include "study/metric.h"

namespace culprit::study {
namespace {

// In the order of Metric.
constexpr std::array<MetricTraits, kMetricCount> kTraits = {{
    {"ratio", "resolved / executed", R"($\frac{f_\text{resolved}}{s_\text{executed}}$)",
     "Failures that went away for each strategy that was executed; above 1 where one strategy "
     "ended "
     "several failures.",
     Better::kHigher, false},
    {"reaction_s", "reaction [s]", R"($t_\text{react}$[s])",
     "From the detection of a failure to its end; failures without an end are not in it.",
     Better::kLower, false},
    {"downtime_s", "downtime [s]", R"($t_\text{down}$[s])",
     "Gaps between segmentations; what is missing at the end of a run is not in it.",
     Better::kLower, false},
    {"unnecessary_redeployments", "unnecessary redeployments", R"($\text{\#rdply}_\text{u}$)",
     "Redeployments beyond those that a fault needed.", Better::kLower, true},
    {"honest_downtime_s", "honest downtime [s]", R"($t_\text{down}^\text{honest}$[s])",
     "Gaps between segmentations, also those at the beginning and at the end of a run.",
     Better::kLower, false},
    {"strategies_per_fault", "strategies per fault", R"($s_\text{executed}$ per fault)",
     "Strategies that were executed for each fault that went in.", Better::kLower, false},
    {"wrong_component", "wrong component", "wrong component",
     "Adaptations of components that were well.", Better::kLower, true},
    {"unresolved", "unresolved failures", "unresolved",
     "Failures that were still there at the end of a run.", Better::kLower, true},
    {"recovery_s", "recovery [s]", R"($t_\text{recover}$[s])",
     "From the first fault until all was well again; a run that did not get there counts to its "
     "end.",
     Better::kLower, false},
    {"root_cause_top1", "root cause top-1", "top-1",
     "Share of diagnoses whose most blamed component is a cause.", Better::kHigher, false},
    {"root_cause_exact", "root causes exact", "exact",
     "Share of diagnoses that blamed all causes and nothing else.", Better::kHigher, false},
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
