// Two rules of when to act, without any probability: what timing alone is worth.
//
// Both repair each failure X with its cheapest strategy that was not tried yet (paper, Eq. 1), as
// soon as nothing says that something upstream of X may be its cause. U is any rule upstream of X.
//
//   patient w   X was detected w ago or earlier, and no U is failing, is being repaired, or was
//               failing within the last w.
//   informed    knows L, how long each rule takes to show a change: its detector's latency.
//                 1. No U is failing or being repaired.
//                 2. Each U could have fired by now if it were the cause:
//                    now >= detected(X) - L(X) + L(U) + 0.6 s, the last for readings.
//                 3. If U was failing before, X is no echo of it:
//                    now >= cleared(U) - L(U) + 1 s + L(X) + 0.6 s, with 1 s for the passing on.
#pragma once

#include <vector>

#include "plan/planner.h"
#include "rca_study/rca_scenario.h"

namespace culprit::study::rca {

class TimingPlanner : public Planner {
 public:
  std::vector<Decision> plan(std::span<const RuleId> failures,
                             const Knowledge& knowledge) const override;

 private:
  // When the failure is old enough to act on if nothing is upstream of it.
  virtual Time ripe(RuleId failure, const Knowledge& knowledge) const = 0;
  // When `upstream`, which is not failing, no longer speaks against acting on the failure.
  virtual Time ripe(RuleId failure, RuleId upstream, const Knowledge& knowledge) const = 0;
};

class PatientPlanner : public TimingPlanner {
 public:
  static constexpr Duration kLeast = std::chrono::milliseconds(500);
  static constexpr Duration kMost = std::chrono::seconds(5);
  static constexpr Duration kUsual = std::chrono::milliseconds(3400);

  explicit PatientPlanner(Duration wait) : wait_(wait) {}

 private:
  Time ripe(RuleId failure, const Knowledge& knowledge) const override;
  Time ripe(RuleId failure, RuleId upstream, const Knowledge& knowledge) const override;

  Duration wait_;
};

class InformedPlanner : public TimingPlanner {
 public:
  explicit InformedPlanner(const RcaScenario& scenario);

 private:
  Time ripe(RuleId failure, const Knowledge& knowledge) const override;
  Time ripe(RuleId failure, RuleId upstream, const Knowledge& knowledge) const override;
  Duration latency(RuleId rule, const Knowledge& knowledge) const;

  std::vector<Duration> latencies_;  // L, by component
};

}  // namespace culprit::study::rca
