// Which faults a drill injects, in which order, and how long that takes.
//
// The plan is made before anything is asked of the robot, so that a person can read it first.
//   - Each round has every fault once, in an order drawn from the seed; so a budget cuts all faults alike.
//   - A component is broken only if an owner on this computer could start it now, and never if the rules exclude it
//     (DRILL lines).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/expected.h"
#include "drill/fault.h"
#include "drill/trial.h"
#include "language/rule_set.h"

namespace culprit::drill {

struct PlanOptions {
  std::vector<std::string> only{};   // components; empty: all
  std::vector<FaultKind> kinds{};    // empty: all but loss, which changes the firewall
  int times = 1;                     // rounds
  bool pairs = false;                // also two components killed at once
  std::optional<Duration> budget{};  // the plan ends with the last fault that fits
  std::uint64_t seed = 1;
  Duration hang = std::chrono::seconds(3);      // how long a process is stopped, or slow
  std::map<std::string, std::string> spared{};  // components that must not be broken, and why
};

struct Step {
  std::vector<Fault> faults;
  int round = 1;
  // "kill camera #2": which one it is when a drill is resumed.
  std::string id() const;
};

struct DrillPlan {
  std::vector<Step> steps;
  std::map<std::string, std::string> left_out;  // component, and why none of its faults is there
  std::size_t beyond_budget = 0;                // steps
  Duration estimate{};
};

// Errors: `only` or a DRILL line names a component that the rules do not declare.
Expected<DrillPlan> plan(const RuleSet& rules, const PlanOptions& options);

// How long one step takes: health before, the reaction, health after.
Duration estimate(const Step& step, const RuleSet& rules, const PlanOptions& options);

// "DRILL arm limit 3" if that many faults of a component of the step were injected already, in trials that prove nothing, too.
// Empty: the step may be done.
std::string limit_reached(const Step& step, const std::vector<Trial>& trials, const RuleSet& rules);

// For people: one line a fault, then the estimate.
std::vector<std::string> plan_lines(const DrillPlan& plan, const PlanOptions& options);

// Health has to last so long before a fault and after it.
inline constexpr Duration kCalm = std::chrono::seconds(3);

}  // namespace culprit::drill
