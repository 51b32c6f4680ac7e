// Absent is not dead, on live robots: typing mistakes, empty robots, late nodes, and what died with
// culprit.
#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "demo/test_live_sunset.h"
#include "exemplars/sunset/node_process.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using sunset::Member;
using testing::HasSubstr;
using testing::Not;

struct NeverSeen : testing::Test {
  std::string rules(const std::string& trigger) const {
    return world.write(
        "one.rules",
        "ROBOT one_camera\n"
        "COMPONENT camera NODE /managed_subsystem/camera LAUNCH \"sunset-node camera\"\n"
        "RULE Dead\n  POLICIES ERROR\n  TRIGGER " +
            trigger + "\n    STRATEGY camera_redeploy 90 10\n      ADAPTATION camera redeploy 5\n");
  }
  TestProgram run(const std::string& file) const {
    const std::string state = (world.folder() / "state").string();
    return TestProgram(world, {"culprit", "run", file, "--settle", "3", "--state-dir", state});
  }
  static std::size_t cameras() {
    return sunset::processes_of(Member::kCamera, ros2::options_from_environment()->domain).size();
  }

  TestWorld world;
};

TEST_F(NeverSeen, ATypingMistakeEndsNobody) {
  TestProgram camera(world, {"sunset-node", "camera"});
  TestProgram culprit = run(rules("age(/managed_subsystem/rgb_camra) > 500ms"));
  ASSERT_TRUE(
      culprit.prints("/managed_subsystem/rgb_camra was never seen: no node publishes it; did "
                     "you mean '/managed_subsystem/rgb_camera'?"))
      << culprit.output();
  culprit.signal(SIGINT);
  EXPECT_EQ(culprit.wait(), 0);
  EXPECT_THAT(culprit.output(), Not(HasSubstr("Dead detected")));
  EXPECT_EQ(camera.wait(0s), std::nullopt) << "it goes on";
}

TEST_F(NeverSeen, ANodeThatComesLateIsNotStartedASecondTime) {
  TestProgram culprit = run(rules("!alive(camera) || age(/managed_subsystem/rgb_camera) > 500ms"));
  ASSERT_TRUE(culprit.prints("camera was never seen: the robot has no node")) << culprit.output();
  EXPECT_EQ(cameras(), 0u) << "an empty robot stays empty";
  const TestProgram camera(world, {"sunset-node", "camera"});
  ASSERT_TRUE(culprit.prints("camera is there")) << culprit.output();
  culprit.signal(SIGINT);
  EXPECT_EQ(culprit.wait(), 0);
  EXPECT_THAT(culprit.output(), Not(HasSubstr("held responsible")));
  EXPECT_EQ(cameras(), 1u);
}

TEST_F(NeverSeen, WhatDiedWithCulpritIsKnownToHaveDied) {
  const lab::LiveSunset robot(world);
  {
    TestProgram first = run("rules/sunset.rules");
    for (const char* name : {"camera", "depth", "image_enhancement", "fusion", "segmentation"})
      ASSERT_TRUE(first.prints(std::string(name) + " is there")) << first.output();
    ASSERT_TRUE(robot.is_well_within(60s)) << robot.complaint() << "\n" << first.output();
    first.signal(SIGKILL);
    EXPECT_EQ(first.wait(), -SIGKILL);
  }
  for (const Member member : {Member::kCamera, Member::kDepth, Member::kSegmentation}) {
    for (const int pid : robot.processes(member)) kill(pid, SIGKILL);
  }
  TestProgram second = run("rules/sunset.rules");
  EXPECT_TRUE(second.prints("camera is there", 60s)) << second.output();
  EXPECT_TRUE(robot.is_well_within(60s)) << robot.complaint() << "\n" << second.output();
  EXPECT_THAT(second.output(), Not(HasSubstr("a person must look")));
  second.signal(SIGINT);
  EXPECT_EQ(second.wait(), 0);
}

// If two nodes fit a component without NODE, neither is touched. An observer of the marker also
// sees the second arm: they are one participant.
TEST_F(NeverSeen, ANameThatTwoNodesHaveIsActedOnByNobody) {
  const std::string domain = std::to_string(ros2::options_from_environment()->domain);
  TestProgram first(world, {"ros2_peer_node", domain, "/r1/arm"});
  TestProgram second(world, {"ros2_peer_node", domain, "/r2/arm", "/r2/marker"});
  TestProgram culprit =
      run(world.write("arm.rules",
                      "ROBOT arms\nCOMPONENT marker NODE /r2/marker\n"
                      "COMPONENT arm LAUNCH \"ros2_peer_node " +
                          domain +
                          " /r1/arm\"\n"
                          "RULE Here\n  POLICIES ERROR\n  TRIGGER alive(arm) && alive(marker)\n"
                          "    STRATEGY arm_redeploy 90 10\n"
                          "      ADAPTATION arm redeploy 5\n"));
  EXPECT_TRUE(culprit.prints("redeploy arm: failed, it could be /r")) << culprit.output();
  culprit.signal(SIGINT);
  EXPECT_EQ(culprit.wait(), 0);
  EXPECT_EQ(first.wait(0s), std::nullopt) << culprit.output();
  EXPECT_EQ(second.wait(0s), std::nullopt) << culprit.output();
}

}  // namespace
}  // namespace culprit::cli
