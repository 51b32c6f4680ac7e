// Test files of rules: whatever the text is, it is read to its end, every diagnostic renders, and
// what is free of errors can be played.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "language/checker.h"
#include "plan/bayes/bayes_planner.h"
#include "rule_test/reader.h"
#include "rule_test/runner.h"

namespace {

using namespace culprit;

// The corpus speaks of these names.
const RuleSet& rules() {
  static const RuleSet kRules = *check(Source("fuzz.rules", R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion LAUNCH "fusion"
SIGNAL blur  DIAGNOSTIC camera KEY blur STALE 1s
RULE CameraDead
  POLICIES ERROR
  TRIGGER age(/rgb) > 350ms || level(camera) > 1
    STRATEGY restart 50 10
      ADAPTATION camera restart 3
RULE Blurred
  POLICIES WARNING
  TRIGGER blur > 0.5
    STRATEGY restart 50 10
      ADAPTATION fusion restart 3
    STRATEGY focus 90 10
      ADAPTATION camera set_parameter focus true 3
)"))
                                     .rules;
  return kRules;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Source source("fuzz.test", std::string(reinterpret_cast<const char*>(data), size));
  std::vector<Diagnostic> diagnostics;
  rule_test::rule_files(source, diagnostics);
  const rule_test::Suite suite = rule_test::read_suite(source, rules(), diagnostics);
  for (const Diagnostic& diagnostic : diagnostics)
    if (render(diagnostic, source).empty()) __builtin_trap();
  const bool is_usable = std::all_of(diagnostics.begin(), diagnostics.end(),
                                     [](const auto& d) { return d.severity != Severity::kError; });
  // Longer ones say nothing new, and take long.
  constexpr Duration kShort = std::chrono::seconds(10);
  for (const rule_test::Test& test : suite.tests) {
    if (test.length > rule_test::kLongestRun) __builtin_trap();
    if (is_usable && test.length <= kShort && size < 2000)
      rule_test::run_test(rules(), suite, test, std::make_unique<BayesPlanner>());
  }
  return 0;
}
