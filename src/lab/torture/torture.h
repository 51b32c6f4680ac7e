// Deterministic simulation testing (FoundationDB's way): whole robots with all that can go wrong,
// from seeds, in virtual time. The same seed gives the same run, bit for bit, on every machine.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "torture/invariants.h"
#include "torture/torture_scenario.h"

namespace culprit::torture {

struct RunOutcome {
  std::optional<Violation> violation;
  std::vector<std::string> timeline;  // one line for each thing that happened
  std::uint64_t steps = 0;
};

// Runs the scenario to its end, or to the first violation. Afterwards it must hold too that
// - every part works, or a report excuses it. Excuses are a storm or a pause. For the part, or for
//   one that it needs, they are an exhausted rule, a silence, a refusal or an unanswered question.
//   So is waiting for a rule with one of these that may be its cause as far as can be observed;
// - the same observations give the same commands and events again.
RunOutcome run(const Scenario& scenario);

// A part of `scenario` that is violated as well, with as little in it as can be found by leaving
// out one thing after the other. @pre it is violated
Scenario shrink(Scenario scenario);

// "seed 17: the budget overall is exceeded at 12.300 s", and the timeline of the smaller scenario.
std::string report(const Scenario& smallest);

}  // namespace culprit::torture
