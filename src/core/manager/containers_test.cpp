// A component container that ends takes its components with it: one fault, one repair.
#include <gtest/gtest.h>

#include "knowledge/awaited_container.h"
#include "manager/test_robot.h"

namespace culprit::test {
namespace {

constexpr const char* kBoxRules = R"(
CYCLE 100ms
COMPONENT box NODE /box LAUNCH "box"
COMPONENT detector NODE /detector IN /box PLUGIN p::Detector
COMPONENT tracker NODE /tracker IN /box PLUGIN p::Tracker
)";
constexpr const char* kPartsGone = R"(
RULE ADetectorGone
  POLICIES ERROR
  TRIGGER !alive(detector)
    STRATEGY detector_redeploy 90 10
      ADAPTATION detector redeploy 5
RULE ZTrackerGone
  POLICIES ERROR
  TRIGGER age(/tracks) > 300ms
    STRATEGY tracker_redeploy 90 10
      ADAPTATION tracker redeploy 5
)";
constexpr const char* kBoxGone = R"(
RULE BoxGone
  POLICIES ERROR
  TRIGGER !alive(box)
    STRATEGY box_redeploy 90 10
      ADAPTATION box redeploy 5
)";

TestRobot robot_with_box(const std::string& rules, bool is_run_as_recommended = true) {
  Manager::Options options;
  if (is_run_as_recommended) options.governor = Governor::Options::recommended();
  TestRobot robot(kBoxRules + rules, std::make_unique<BayesPlanner>(), options);
  robot.add("box");
  robot.add("detector");
  robot.add("tracker", {}, "/tracks");
  for (const std::string name : {"detector", "tracker"}) robot[name].pid = robot["box"].pid;
  robot.discover();
  robot.tell(EndpointAppeared{"/tracker", EndpointKind::kPublisher, "/tracks"}, 6s);
  return robot;
}

void kill_all(TestRobot& robot, const std::vector<std::string>& order) {
  for (const std::string& name : order) robot.kill(name);
}

// As the program that starts the container does.
void load_parts_when_it_is_up(TestRobot& robot, Duration load) {
  for (int i = 0; i < 500 && !robot.works("box"); ++i) robot.run_for(10ms);
  ASSERT_TRUE(robot.works("box"));
  robot.run_for(load);
  robot.start_by_hand("detector", load);
  robot.start_by_hand("tracker");
}

TEST(AContainer, ThatIsKilledIsOneFaultAndOneRepair) {
  const std::vector<std::vector<std::string>> orders = {{"box", "detector", "tracker"},
                                                        {"detector", "tracker", "box"},
                                                        {"tracker", "box", "detector"}};
  for (const bool is_run_as_recommended : {true, false}) {
    for (const auto& order : orders) {
      for (const Duration load : {Duration(50ms), Duration(2s)}) {
        TestRobot robot = robot_with_box(std::string(kPartsGone) + kBoxGone, is_run_as_recommended);
        const Time killed = robot.now;
        kill_all(robot, order);
        load_parts_when_it_is_up(robot, load);
        EXPECT_LT(robot.now - killed, 1s + 2 * load);
        robot.run_for(20s);
        EXPECT_EQ(robot.count_asked("start process"), 1u);
        EXPECT_FALSE(robot.was_asked("detector: stop"));
        EXPECT_FALSE(robot.was_asked("tracker: stop"));
        EXPECT_EQ(robot.count("is held responsible"), 1u);
        EXPECT_EQ(robot.count("box is held responsible"), 1u);
        EXPECT_EQ(robot.count("ADetectorGone cleared"), 1u);
        EXPECT_EQ(robot.count("ZTrackerGone cleared"), 1u);
      }
    }
  }
}

// No rule replaces the container: the first component that asks has it started.
TEST(AContainer, ThatNoRuleReplacesIsStartedForItsComponents) {
  TestRobot robot = robot_with_box(kPartsGone);
  kill_all(robot, {"box", "detector", "tracker"});
  robot.run_for(2s);
  EXPECT_TRUE(robot.was_asked("detector: start process"));
}

// It is up, and does not load what it had.
TEST(AContainer, ThatDoesNotLoadAComponentIsNotWaitedForForever) {
  TestRobot robot = robot_with_box(std::string(kPartsGone) + kBoxGone);
  kill_all(robot, {"box", "detector", "tracker"});
  for (int i = 0; i < 500 && !robot.works("box"); ++i) robot.run_for(10ms);
  robot.start_by_hand("detector", kContainerLoads - 1s);
  EXPECT_FALSE(robot.was_asked("tracker:"));
  robot.run_for(20s);
  EXPECT_TRUE(robot.was_asked("tracker: start process"));
  EXPECT_TRUE(robot.works("tracker"));
}

// One of its components alone says nothing of it.
TEST(AContainer, ThatRunsIsNotHeldResponsibleForAComponentOfIt) {
  TestRobot robot = robot_with_box(std::string(kPartsGone) + kBoxGone);
  robot["detector"].is_in_graph = false;
  robot.tell(NodeVanished{"/detector"}, 10s);
  EXPECT_TRUE(robot.was_asked("detector: start process"));
  EXPECT_FALSE(robot.was_asked("box: stop process"));
}

// As `ros2 component unload` does.
void unload_by_hand(TestRobot& robot, const std::string& name) {
  robot[name].is_in_graph = false;
  robot.tell(NodeVanished{"/" + name}, 600ms);
  robot.tell(Unloaded{robot.id(name)});
}

TEST(AContainer, FromWhichAPersonUnloadedAComponentIsNotAskedToLoadIt) {
  TestRobot robot = robot_with_box(std::string(kPartsGone) + kBoxGone);
  unload_by_hand(robot, "detector");
  robot.run_for(1min);
  EXPECT_FALSE(robot.was_asked("detector: st"));
  EXPECT_EQ(robot.count("detector stays down: it was unloaded, and not by culprit"), 1u);
  robot.order({1, "ann", "", Revive{}}, 20s);
  EXPECT_TRUE(robot.was_asked("detector: start process"));
  EXPECT_TRUE(robot.works("detector"));
}

TEST(AContainer, IntoWhichAPersonLoadsAComponentAgainIsAsAnyOther) {
  TestRobot robot = robot_with_box(std::string(kPartsGone) + kBoxGone);
  unload_by_hand(robot, "detector");
  robot.run_for(5s);
  robot["detector"].is_in_graph = true;
  robot.tell(NodeAppeared{"/detector", robot["detector"].pid}, Departures::kBack + 5s);
  EXPECT_FALSE(robot.was_asked("detector: st"));
  robot["detector"].is_in_graph = false;
  robot.tell(NodeVanished{"/detector"}, 10s);
  EXPECT_TRUE(robot.was_asked("detector: start process"));
}

// The component was of no launch any more.
TEST(AContainer, ThatAPersonEndedIsNotStartedForAComponentThatWasRevived) {
  constexpr int kLauncher = 50;
  TestRobot robot = robot_with_box(kPartsGone);
  for (const std::string name : {"box", "detector", "tracker"})
    robot.tell(LauncherSeen{robot.id(name), kLauncher, false});
  unload_by_hand(robot, "detector");
  robot.order({1, "ann", "", Revive{}}, 20s);
  ASSERT_TRUE(robot.works("detector"));
  robot.asked.clear();
  for (const std::string name : {"detector", "tracker", "box"}) robot.leave(name);
  for (const std::string name : {"box", "tracker"})
    robot.tell(LauncherSeen{robot.id(name), kLauncher, true});
  robot.run_for(1min);
  EXPECT_FALSE(robot.was_asked("start process"));
}

// It did not answer the request to unload a component. It was the last of its launch, which ends.
TEST(AContainer, ThatCulpritReplacesForAComponentWasNotEndedByAPerson) {
  constexpr int kLauncher = 50;
  TestRobot robot = robot_with_box(std::string(kPartsGone) + kBoxGone);
  for (const std::string name : {"box", "detector", "tracker"})
    robot.tell(LauncherSeen{robot.id(name), kLauncher, false});
  robot["tracker"].fault = "redeploy";
  while (!robot.was_asked("tracker: stop process")) robot.run_for(10ms);
  robot.leave("box");
  robot.leave("detector", 300ms);
  for (const std::string name : {"box", "detector", "tracker"})
    robot.tell(LauncherSeen{robot.id(name), kLauncher, true});
  robot.run_for(1min);
  EXPECT_EQ(robot.count("stay"), 0u);
  EXPECT_TRUE(robot.works("box"));
}

}  // namespace
}  // namespace culprit::test
