// No alarm is not health: each state that nobody can call well has a look of its own.
#include "web/overview.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "manager/test_robot.h"
#include "web/component_health.h"
#include "web/robot_json.h"

namespace culprit::web {
namespace {

using namespace std::chrono_literals;
using test::TestRobot;
using testing::HasSubstr;

constexpr const char* kOverviewRules = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT lamp   NODE /lamp
COMPONENT lidar  NODE /lidar
RULE CameraDead
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY redeploy_camera 90 10
      ADAPTATION camera redeploy 20
RULE Dark
  POLICIES WARNING
  TRIGGER brightness < 0.5
    STRATEGY light 90 10
      ADAPTATION lamp set_parameter on 1 2
)";

struct Overlooked {
  explicit Overlooked(const std::string& rules = kOverviewRules) : robot(rules) {}
  void run(Duration time) {
    for (Duration passed{}; passed < time; passed += 1s) {
      if (is_bright) robot.signal("brightness", Value(1.0));
      robot.run_for(1s);
    }
  }
  // These are there, and watched for so long.
  void show(const std::vector<std::string>& names, Duration time) {
    for (const std::string& name : names) robot.add(name, {}, name == "camera" ? "/rgb" : "");
    robot.discover();
    run(time);
  }
  Overview overview() { return overview_of(robot.manager()); }
  ComponentLook look(std::size_t component) {
    const auto health = health_of_components(robot.manager().knowledge());
    return look_of(ComponentId(component), health[component], robot.manager());
  }

  TestRobot robot;
  bool is_bright = true;
};

TEST(Overview, SaysThatAllIsWellOnlyIfEachComponentIsThere) {
  Overlooked some;
  some.show({"camera", "lamp"}, 1s);
  EXPECT_EQ(some.overview().headline, "lidar is not seen yet");
  EXPECT_EQ(some.look(2).condition, "not seen yet");
  some.run(29s);
  EXPECT_EQ(some.overview().look, "NEVER_SEEN");
  EXPECT_EQ(some.overview().headline, "lidar was never seen");
  EXPECT_THAT(some.overview().detail, HasSubstr("NODE"));
  EXPECT_EQ(some.look(0).look, "OK");
  EXPECT_EQ(some.look(2).look, "NEVER_SEEN");
  EXPECT_EQ(some.look(2).condition, "never seen");
}

TEST(Overview, NeverCallsARobotWellOfWhichAComponentWithoutARuleIsDown) {
  Overlooked some;
  some.show({"camera", "lamp", "lidar"}, 30s);
  some.robot.kill("lidar");
  some.run(30s);
  EXPECT_EQ(some.overview().look, "DEAD");
  EXPECT_EQ(some.overview().headline, "lidar is down");
  EXPECT_EQ(some.overview().detail, "no rule reports it as a failure");
  EXPECT_EQ(some.look(2).look, "DEAD");
}

TEST(Overview, GivesAComponentWithoutARuleNoHealth) {
  Overlooked some;
  some.show({"camera", "lamp", "lidar"}, 30s);
  EXPECT_EQ(some.look(2).look, "UNWATCHED");
  EXPECT_EQ(some.overview().look, "OK");
  EXPECT_EQ(some.overview().headline, "all is well");
  EXPECT_EQ(some.overview().detail, "no failure is seen by 2 rules");
}

TEST(Overview, NamesTheRuleThatIsBlind) {
  Overlooked some;
  some.is_bright = false;
  some.show({"camera", "lamp"}, 60s);
  EXPECT_EQ(some.overview().look, "BLIND");
  EXPECT_EQ(some.overview().headline, "no failure is seen, but Dark is blind");
  EXPECT_THAT(some.overview().detail, HasSubstr("brightness"));
  EXPECT_EQ(some.look(1).look, "BLIND");
  EXPECT_EQ(some.look(0).look, "OK");
}

TEST(Overview, NeverCallsARobotWellThatNoRuleCanSee) {
  Overlooked none;
  none.is_bright = false;
  none.robot.discover();
  none.run(60s);
  EXPECT_EQ(none.overview().look, "WATCHING_NOTHING");
  EXPECT_EQ(none.overview().headline, "watching nothing: no rule can see");
  Overlooked without_rules("COMPONENT camera NODE /camera\n");
  without_rules.is_bright = false;
  without_rules.run(5s);
  EXPECT_EQ(without_rules.overview().headline, "watching nothing: there is no rule");
}

TEST(Overview, SaysWhatIsRequiredAndMissing) {
  Overlooked some("COMPONENT camera NODE /camera REQUIRED\n");
  some.is_bright = false;
  some.robot.discover();
  some.run(30s);
  EXPECT_EQ(some.overview().look, "MISSING");
  EXPECT_EQ(some.overview().headline, "camera is REQUIRED and is not there");
}

TEST(Overview, SaysThatItCannotHearTheRobot) {
  Overlooked some;
  some.show({"camera", "lamp"}, 30s);
  some.robot.tell(HearingLost{"a test"});
  some.run(1s);
  EXPECT_EQ(some.overview().look, "DEAF");
  EXPECT_EQ(some.look(0).look, "BLIND");
}

TEST(Overview, SaysOfNoComponentThatWasSeenThatItWasNot) {
  Overlooked some;
  some.show({"camera", "lamp"}, 30s);
  some.robot.tell(HearingLost{"a test"});
  some.robot.tell(NodeVanished{"/camera"});
  some.run(1s);
  ASSERT_FALSE(some.robot.manager().knowledge().components[ComponentId(0)].alive);
  EXPECT_EQ(some.look(0).look, "BLIND");
  EXPECT_THAT(some.look(0).condition, testing::AnyOf("unknown", "starting"));
  EXPECT_EQ(some.look(2).look, "NEVER_SEEN");
}

TEST(Overview, SaysWhoseSimulatedTimeStandsStill) {
  Overlooked some;
  some.show({"camera", "lamp", "lidar"}, 10s);
  some.robot.tell(TimeHeld{ComponentId(0), true});
  some.run(5s);
  EXPECT_EQ(some.overview().look, "TIME_HELD");
  EXPECT_EQ(some.overview().headline, "the simulated time of camera stands still");
  EXPECT_EQ(some.look(0).look, "TIME_HELD");
  EXPECT_EQ(some.look(0).condition, "clock paused");
  EXPECT_EQ(some.look(1).look, "OK") << "it has a clock of its own";
  some.robot.tell(TimeHeld{ComponentId(0), false});
  some.run(5s);
  EXPECT_EQ(some.overview().look, "OK");
  EXPECT_EQ(some.look(0).look, "OK");
}

// A person ordered it: that something is done to a component does not make it ill.
TEST(Overview, CallsNoComponentIllBecauseAStrategyIsUnderWayWithoutAFailure) {
  Overlooked some;
  some.show({"camera", "lamp", "lidar"}, 30s);
  some.robot["lamp"].parameters["on"] = Value(std::int64_t{0});
  some.robot.order({1, "ada", "", RunStrategy{StrategyId(1)}});
  const RuleStates& states = some.robot.manager().knowledge().states;
  for (int i = 0; i < 100 && !states[RuleId(1)].attempt; ++i) some.robot.run_for(1ms);
  ASSERT_EQ(states[RuleId(1)].phase, RulePhase::kAttempting);
  EXPECT_EQ(some.overview().headline, "all is well");
  EXPECT_EQ(some.look(1).look, "OK") << "as the headline says";
  EXPECT_EQ(incidents_to_json(some.robot.manager(), Time{}), Json::array());
}

TEST(Overview, IsTheFirstIncidentAndCountsTheOthers) {
  Overlooked some;
  some.show({"camera", "lamp"}, 30s);
  some.robot["lamp"].parameters["on"] = Value(std::int64_t{0});
  some.robot.order({1, "ada", "", Pause{}});
  some.is_bright = false;
  some.robot.signal("brightness", Value(0.1));
  some.robot.kill("camera", 1s);
  EXPECT_EQ(some.overview().look, "ERROR");
  EXPECT_EQ(some.overview().headline, "camera is down, and 1 more");
  EXPECT_EQ(some.overview().detail, "nothing is done: culprit is paused");
  EXPECT_EQ(some.look(0).condition, "down");
}

// The camera is held responsible for both failures; fusion would be for its own if the camera's rule did not fire.
TEST(Overview, SaysWhatTheBlameHingesOn) {
  Overlooked some(R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion
RULE CameraDead
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY redeploy_camera 90 10
      ADAPTATION camera redeploy 20
RULE FusionSilent
  POLICIES ERROR
  TRIGGER age(/fused) > 1s
    STRATEGY restart_fusion 90 10
      ADAPTATION fusion restart 5
)");
  some.is_bright = false;
  some.robot.add("camera", {}, "/rgb");
  some.robot.add("fusion", {"camera"}, "/fused");
  some.robot.discover();
  some.run(30s);
  some.robot.order({1, "ada", "", Pause{}});
  some.robot.kill("camera", 3s);
  const Json incident = incidents_to_json(some.robot.manager(), Time{}).at(0);
  ASSERT_EQ(incident["consequences"], Json::array({"FusionSilent"}));
  const Json wanted{{"rule", "FusionSilent"}, {"text", "CameraDead fires"}, {"without", "fusion"}};
  const Json& hinges = incident["hinges_on"];
  EXPECT_NE(std::ranges::find(hinges, wanted), hinges.end()) << to_line(hinges);
}

}  // namespace
}  // namespace culprit::web
