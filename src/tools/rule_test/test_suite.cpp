#include "rule_test/test_suite.h"

#include <gtest/gtest.h>

#include "language/checker.h"
#include "plan/paper_planner.h"

namespace culprit::rule_test {

const char* const kPipeline = R"(COMPONENT camera PUBLISHES /rgb blur
COMPONENT fusion NEEDS camera  PUBLISHES /fused
TOPIC /rgb 0s: 10Hz
TOPIC /fused 0s: 10Hz
SIGNAL blur 0s: 0.1
)";

RuleSet pipeline_rules(const std::string& more) {
  const std::string rules = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion LAUNCH "fusion"
SIGNAL blur  DIAGNOSTIC camera KEY blur STALE 1s
RULE CameraDead
  POLICIES ERROR ATTEMPTS 2
  TRIGGER age(/rgb) > 350ms
    STRATEGY camera_restart 50 10
      ADAPTATION camera restart 3
    STRATEGY camera_redeploy 90 10
      ADAPTATION camera redeploy 10
RULE FusionDead
  POLICIES ERROR
  TRIGGER age(/fused) > 350ms
    STRATEGY fusion_restart 50 10
      ADAPTATION fusion restart 3
    STRATEGY fusion_redeploy 90 10
      ADAPTATION fusion redeploy 10
RULE Blurred
  POLICIES WARNING
  TRIGGER blur > 0.5
    STRATEGY focus 90 10
      ADAPTATION camera set_parameter focus true 3
)";
  const Source source("pipeline.rules", rules + more);
  Checked checked = check(source);
  for (const Diagnostic& d : checked.diagnostics) ADD_FAILURE() << render(d, source);
  return checked.rules ? std::move(*checked.rules) : RuleSet{};
}

std::vector<std::string> Played::instead() const {
  std::vector<std::string> lines;
  for (const Disappointment& d : result.disappointments) lines.push_back(d.instead);
  return lines;
}

Played play(const std::string& test, const std::string& more_rules) {
  Played played{Source("x.test", std::string(kPipeline) + "TEST t\n" + test),
                pipeline_rules(more_rules),
                {},
                {}};
  std::vector<Diagnostic> diagnostics;
  played.suite = read_suite(played.source, played.rules, diagnostics);
  for (const Diagnostic& d : diagnostics) ADD_FAILURE() << render(d, played.source);
  if (diagnostics.empty())
    played.result = run_test(played.rules, played.suite, played.suite.tests.at(0),
                             std::make_unique<PaperPlanner>());
  return played;
}

}  // namespace culprit::rule_test
