// States of a robot: whatever the text is, it is read to its end and every diagnostic renders; what
// is free of errors can be watched and planned for, and what flips a decision can be said.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "language/checker.h"
#include "plan/decision.h"
#include "plan/paper_planner.h"
#include "rule_test/reader.h"
#include "rule_test/state.h"

namespace {

using namespace culprit;

// The corpus speaks of these names.
const RuleSet& rules() {
  static const RuleSet kRules = *check(Source("fuzz.rules", R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion
SIGNAL blur  DIAGNOSTIC camera KEY blur STALE 1s
RULE CameraDead
  POLICIES ERROR
  TRIGGER age(/rgb) > 350ms || level(camera) > 1
    STRATEGY restart 50 10
      ADAPTATION camera restart 3
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 10
RULE Blurred
  POLICIES WARNING HOLD 2/3
  TRIGGER blur > 0.5
    STRATEGY calm 50 10 WHEN lifecycle(fusion) != "inactive"
      ADAPTATION fusion restart 3
    STRATEGY focus 90 10
      ADAPTATION camera set_parameter focus true 3
)"))
                                     .rules;
  return kRules;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Source source("fuzz.state", std::string(reinterpret_cast<const char*>(data), size));
  std::vector<Diagnostic> diagnostics;
  const rule_test::State state = rule_test::read_state(source, rules(), diagnostics);
  for (const Diagnostic& diagnostic : diagnostics)
    if (render(diagnostic, source).empty()) __builtin_trap();
  const Duration moment = rule_test::moment_of(state, rules());
  if (moment > rule_test::kLongestRun) __builtin_trap();
  // Longer ones say nothing new, and take long.
  constexpr Duration kShort = std::chrono::seconds(20);
  if (!diagnostics.empty() || moment > kShort || size > 2000) return 0;
  const rule_test::Watched watched = rule_test::watch(state, rules());
  for (const plan::ExplainedDecision& d :
       plan::decide(PaperPlanner(), watched.failures, *watched.knowledge)) {
    for (std::size_t i = 0; i < d.flips.size(); ++i) {
      const StrategyId loser = d.decision.candidates[i].strategy;
      for (const plan::Change& change : d.flips[i])
        if (plan::describe(change, loser, *watched.knowledge).empty()) __builtin_trap();
    }
  }
  return 0;
}
