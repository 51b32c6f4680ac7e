#include "drill/exported_tests.h"

#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "base/text_file.h"
#include "plan/bayes/bayes_planner.h"
#include "rule_test/file_run.h"

namespace culprit::drill {
namespace {

constexpr const char* kExported = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion LAUNCH "fusion"
RULE CameraDead
  POLICIES ERROR
  TRIGGER age(/rgb) > 350ms
    STRATEGY camera_redeploy 90 10
      ADAPTATION camera redeploy 5
RULE FusionDead
  POLICIES ERROR
  TRIGGER age(/fused) > 350ms
    STRATEGY fusion_redeploy 90 10
      ADAPTATION fusion redeploy 5
)";

TEST(DrillExport, WritesTestsThatTheRulesPass) {
  const test::TestFolder folder;
  const std::string rules = (folder.path() / "my \"best\" r.rules").string();
  ASSERT_TRUE(write_text(rules, kExported));
  Trial trial{{Fault{FaultKind::kKill, "camera"}}, 1, 100, {}, 101.2, 104};
  trial.silent = {{"fusion", 100.6}};
  trial.events = {{{"clock", 100.4}, {"type", "failure_detected"}, {"rule", "CameraDead"}},
                  {{"clock", 100.5},
                   {"type", "strategy_chosen"},
                   {"rule", "CameraDead"},
                   {"components", {"camera"}}}};
  Trial slow{{Fault{FaultKind::kSlow, "camera"}}, 1, 200, {}, 201, 204};
  HealthyRobot robot;
  robot.lifecycles = {{"camera", "active"}, {"fusion", ""}};
  robot.topics = {{"/rgb", {10, "camera", {"fusion"}}}, {"/fused", {10, "fusion", {}}}};
  const auto count =
      export_tests(folder.path() / "tests", rules, "2026-12-01", {trial, slow}, robot);
  ASSERT_TRUE(count) << count.error();
  EXPECT_EQ(*count, 1u) << "no test can be slow";
  const std::string file = (folder.path() / "tests" / "kill-camera.test").string();
  const auto run = rule_test::run_file(
      file, "", [] { return std::make_unique<BayesPlanner>(); }, Colour::kOff);
  ASSERT_TRUE(run.is_usable) << run.complaints << *read_text(file);
  EXPECT_NE(run.output.find("ok"), std::string::npos) << run.output;
  EXPECT_EQ(run.output.find("FAILED"), std::string::npos) << run.output << *read_text(file);
}

}  // namespace
}  // namespace culprit::drill
