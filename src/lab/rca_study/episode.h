// One episode of the benchmark: a scenario, played by culprit's manager with one planner, and what
// it yields.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "knowledge/latencies.h"
#include "knowledge/transients.h"
#include "plan/planner.h"
#include "rca_study/rca_scenario.h"
#include "study/single_run.h"

namespace culprit::study::rca {

struct EpisodeResult {
  std::int32_t faults = 0;
  // The components that were adapted are those that had a fault: all, and no other. A fault that
  // hides behind another counts when it is found once it shows; one of a component without a rule
  // does not count.
  bool is_exact = false;
  bool is_first_right = false;  // the component adapted first had a fault then
  // Failures that were only effects and waited for another one: their number, and how many waited
  // for a component that did make them ill.
  std::int32_t effects = 0;
  std::int32_t grounded = 0;
  std::int32_t strategies = 0;       // executed
  std::int32_t wrong_component = 0;  // of these, on a component that never had a fault
  std::int32_t unnecessary = 0;      // on one whose fault was gone already, or had not come yet
  std::int32_t unresolved = 0;       // faults still there at the end
  double downtime_s = 0;             // of the robot's outputs, in the mean: what no other reads
  double recovery_s =
      0;  // from the first fault until all was well; if that never was, until the end
  bool is_recovered = false;
  std::int64_t plans = 0;
  double planning_us = 0;  // wall time in all plans
};

// Learned about a rule in earlier episodes on the same robot.
struct Learned {
  Latencies::Learned latencies;
  Transients::Seen transients;
};
// By rule. Empty: nothing.
using Experience = std::vector<Learned>;

// `planner` decides. The same scenario and planner, the same result but for `planning_us`.
EpisodeResult play(const RcaScenario& scenario, std::unique_ptr<const Planner> planner);
// With the scenario's rules (rules.h), for callers that play it more than once; the manager has the
// experience, and it is afterwards what the manager knows then.
EpisodeResult play(const RcaScenario& scenario, const RuleSet& rules,
                   std::unique_ptr<const Planner> planner, Experience& experience);

// The same, to look at moment by moment; and line by line, with the faults.
SingleRun single_run(const RcaScenario& scenario, std::unique_ptr<const Planner> planner,
                     Experience experience);
std::string tell(const SingleRun& run);

}  // namespace culprit::study::rca
