// Components with several nodes in one process: any of them missing or hung counts.
#include <gtest/gtest.h>

#include "manager/manager.h"
#include "manager/test_robot.h"

namespace culprit::test {
namespace {

constexpr const char* kWithCostmap =
    "COMPONENT controller NODE /controller /costmap LAUNCH \"controller\"\n"
    "RULE Dead\n  POLICIES ERROR\n  TRIGGER !alive(controller)\n"
    "    STRATEGY redeploy 90 10\n      ADAPTATION controller redeploy 10\n";

// The costmap comes a moment after the controller, at the start and after each redeploy.
struct Controller {
  explicit Controller() : robot(kWithCostmap) {
    auto& added = robot.add("controller");
    added.has_lifecycle = false;
    pid = added.pid;
    robot.discover();
    costmap_appears();
    robot.run_for(7s);
  }
  void costmap_appears() { robot.tell(NodeAppeared{"/costmap", pid}); }
  void costmap_answers(bool answers) {
    robot.tell(Probed{robot.id("controller"), answers, 1});
    robot.tell(Probed{robot.id("controller"), true});
  }
  bool is_alive() {
    return robot.manager().knowledge().components[robot.id("controller")].alive == true;
  }

  TestRobot robot;
  int pid = 0;
};

TEST(SeveralNodes, AreAliveWhileAllAreThere) {
  Controller it;
  EXPECT_TRUE(it.is_alive());
  EXPECT_EQ(it.robot.count("Dead detected"), 0u);
}

TEST(SeveralNodes, OneThatLeavesHasTheProcessReplaced) {
  Controller it;
  it.robot.tell(NodeVanished{"/costmap"});
  EXPECT_FALSE(it.is_alive());
  EXPECT_EQ(it.robot.count("controller is lost: its node /costmap left the graph"), 1u);
}

TEST(SeveralNodes, OneThatNeverComesBackKeepsTheComponentDown) {
  Controller it;
  it.robot.kill("controller", 1s);
  ASSERT_TRUE(it.robot.was_asked("controller: start"));
  EXPECT_FALSE(it.is_alive());
  it.pid = it.robot["controller"].pid;
  it.costmap_appears();
  it.robot.run_for(1s);
  EXPECT_TRUE(it.is_alive());
  EXPECT_EQ(it.robot.count("Dead resolved by redeploy"), 1u);
}

TEST(SeveralNodes, OneThatCeasesToAnswerHangs) {
  Controller it;
  it.costmap_answers(true);
  for (int i = 0; i < 4; ++i) it.costmap_answers(false);
  EXPECT_TRUE(it.is_alive());
  it.costmap_answers(false);
  EXPECT_FALSE(it.is_alive());
}

// As the nodes that bt_navigator makes for its clients: they answer while a goal runs.
TEST(SeveralNodes, OneThatAnswersNowAndThenNeverHangs) {
  Controller it;
  it.costmap_answers(false);
  it.costmap_answers(true);
  for (int i = 0; i < 20; ++i) it.costmap_answers(false);
  EXPECT_TRUE(it.is_alive());
}

}  // namespace
}  // namespace culprit::test
