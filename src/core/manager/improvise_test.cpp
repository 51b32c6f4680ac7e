// Improvised rules on a robot: components without a rule are repaired, too, and only these.
#include "language/improvise.h"

#include <gtest/gtest.h>

#include "manager/test_robot.h"

namespace culprit::test {
namespace {

constexpr const char* kImproviseRules = R"(COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT map NODE /map LAUNCH "map"
COMPONENT lidar NODE /lidar
RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms
    STRATEGY restart 50 10
      ADAPTATION camera restart 4
)";

std::string improvised() {
  return kImproviseRules + improvised_rules(*check(Source("test.rules", kImproviseRules)).rules);
}

TEST(Improvise, WritesRulesForWhatNobodyAdapts) {
  EXPECT_EQ(improvised_rules(*check(Source("test.rules", kImproviseRules)).rules), R"(
# Improvised: nobody wrote rules for these components.

RULE improvised_map
  POLICIES NON_CRITICAL FOR 2s ATTEMPTS 3
  TRIGGER !alive(map) || lifecycle(map) == "finalized" || lifecycle(map) == "unconfigured"
    STRATEGY improvised_restart 50 2 WHEN lifecycle(map) == "unconfigured"
      ADAPTATION map restart 2
    STRATEGY improvised_redeploy 50 2
      ADAPTATION map redeploy 4

RULE improvised_lidar
  POLICIES NON_CRITICAL FOR 2s ATTEMPTS 3
  TRIGGER lifecycle(lidar) == "unconfigured"
    STRATEGY improvised_restart 50 2 WHEN lifecycle(lidar) == "unconfigured"
      ADAPTATION lidar restart 2
)");
}

TEST(Improvise, HasNothingToAddToItsOwnRules) {
  const Checked checked = check(Source("test.rules", improvised()));
  ASSERT_TRUE(checked.rules);
  auto before = check(Source("test.rules", kImproviseRules)).diagnostics;
  std::erase_if(before, [](const Diagnostic& d) { return d.code == Code::kUnused; });
  EXPECT_EQ(checked.diagnostics.size(), before.size()) << "nothing is wrong with what is added";
  EXPECT_EQ(improvised_rules(*checked.rules), "");
}

TEST(Improvise, ReplacesAProcessThatNoRuleIsAbout) {
  for (const bool is_on : {false, true}) {
    TestRobot robot(is_on ? improvised() : kImproviseRules);
    robot.add("camera", {}, "/rgb");
    robot.add("map");
    robot.add("lidar");
    robot.discover(6s);
    robot.kill("map", 20s);
    EXPECT_EQ(robot.works("map"), is_on);
    EXPECT_EQ(robot.count("improvised_redeploy") > 0, is_on) << "what is said is marked";
  }
}

TEST(Improvise, BringsALifecycleBackAndLeavesAnInactiveOneAlone) {
  TestRobot robot(improvised());
  robot.add("camera", {}, "/rgb");
  robot.add("map").state = Lifecycle::kInactive;
  robot.add("lidar");
  robot.discover(6s);
  robot["lidar"].state = Lifecycle::kUnconfigured;
  robot.tell(LifecycleRead{ComponentId(2), Lifecycle::kUnconfigured}, 20s);
  EXPECT_TRUE(robot.was_asked("lidar: "));
  EXPECT_FALSE(robot.was_asked("map: activate"));
  EXPECT_FALSE(robot.was_asked("map: stop"));
}

}  // namespace
}  // namespace culprit::test
