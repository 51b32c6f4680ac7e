// A running culprit and the nodes of its user: the reports that they receive, and the orders that
// they give.
#include <csignal>
#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ros2/test_keystore.h"
#include "ros_api/test_ros_node.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

using rtps::Durability;

using ros_api::TestRosNode;
using testing::HasSubstr;
using testing::Not;

const std::string kRosApiRules = "ROBOT one_camera\n" + replaced_when_gone("camera");

constexpr const char* kStatusType = "culprit_msgs/msg/Status";
constexpr const char* kPauseType = "culprit_msgs/srv/Pause";

struct RosApiLive : testing::Test {
  std::unique_ptr<TestProgram> run(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"culprit", "run", world.write("one.rules", kRosApiRules),
                                       "--state-dir", (world.folder() / "state").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return std::make_unique<TestProgram>(world, std::move(arguments));
  }
  static ros2::ParticipantOptions options() { return *ros2::options_from_environment(); }

  TestWorld world;
};

TEST_F(RosApiLive, TellsWhatBreaksAndHowItIsHealed) {
  TestProgram camera(world, {"sunset-node", "camera"});
  auto culprit = run();
  ASSERT_TRUE(culprit->prints("camera is there")) << culprit->output();
  TestRosNode panel(options());
  auto& statuses = panel.hear("/culprit/status", kStatusType, Durability::kTransientLocal);
  ASSERT_TRUE(statuses.wait_for_one([](const Json& status) {
    return status["summary"] == "all is well" && status["components"][0]["is_present"] == true;
  }));
  auto& incidents = panel.hear("/culprit/incidents", "culprit_msgs/msg/Incident");
  auto& decisions = panel.hear("/culprit/decisions", "culprit_msgs/msg/Decision");
  ASSERT_TRUE(panel.is_known_to("/culprit")) << "or it would miss what is told once";
  camera.signal(SIGKILL);
  camera.wait();
  const auto constant = [&](const char* type, const char* name) {
    return panel.types.constant("culprit_msgs/msg/" + std::string(type), name);
  };
  EXPECT_TRUE(incidents.wait_for_one([&](const Json& incident) {
    return incident["state"] == constant("Incident", "STATE_OPEN") &&
           incident["headline"] == "camera is down";
  }));
  EXPECT_TRUE(decisions.wait_for_one([&](const Json& decision) {
    return decision["kind"] == constant("Decision", "KIND_BEGUN") &&
           decision["strategy"] == "camera_redeploy";
  }));
  EXPECT_TRUE(decisions.wait_for_one([&](const Json& decision) {
    return decision["kind"] == constant("Decision", "KIND_SUCCEEDED");
  }));
  EXPECT_TRUE(incidents.wait_for_one([&](const Json& incident) {
    return incident["state"] == constant("Incident", "STATE_RESOLVED");
  }));
  // Without keys, no participant of the domain may give orders.
  EXPECT_EQ(
      panel.call("/culprit/pause", kPauseType, {{"author", "ann"}}, std::chrono::milliseconds(500)),
      nullptr);
  EXPECT_THAT(culprit->output(), Not(HasSubstr("orders-from-anyone")));
  culprit->signal(SIGINT);
  EXPECT_EQ(culprit->wait(), 0);
  kill(pid_in(culprit->output(), "camera"), SIGKILL);  // culprit leaves the robot running
}

TEST_F(RosApiLive, ObeysAnyoneIfItIsToldTo) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  auto culprit = run({"--orders-from-anyone"});
  ASSERT_TRUE(culprit->prints("takes orders over DDS from any participant of this domain"))
      << culprit->output();
  ASSERT_TRUE(culprit->prints("camera is there")) << culprit->output();
  TestRosNode panel(options());
  auto& statuses = panel.hear("/culprit/status", kStatusType, Durability::kTransientLocal);
  const Json paused = panel.call("/culprit/pause", kPauseType,
                                 {{"author", "ann"}, {"reason", "people on the floor"}});
  EXPECT_EQ(paused["success"], true) << paused;
  EXPECT_THAT(paused["message"].get<std::string>(), HasSubstr("kept"));
  EXPECT_TRUE(
      statuses.wait_for_one([](const Json& status) { return status["is_paused"] == true; }));
  EXPECT_TRUE(culprit->prints("people on the floor")) << culprit->output();
  // The next process knows of it, and receives the order to go on.
  culprit->signal(SIGKILL);
  culprit->wait();
  culprit = run({"--orders-from-anyone"});
  ASSERT_TRUE(culprit->prints("culprit status")) << culprit->output();
  TestRosNode next(options());
  auto& later = next.hear("/culprit/status", kStatusType, Durability::kTransientLocal);
  EXPECT_TRUE(later.wait_for_one([](const Json& status) { return status["is_paused"] == true; }));
  EXPECT_EQ(next.call("/culprit/resume", "culprit_msgs/srv/Resume", {{"author", "ann"}})["success"],
            true);
  EXPECT_TRUE(later.wait_for_one([](const Json& status) { return status["is_paused"] == false; }));
  // Other rules are another session, at a node of the same name.
  world.write("one.rules", kRosApiRules + "COMPONENT lamp NODE /lamp\n");
  culprit->signal(SIGHUP);
  ASSERT_TRUE(culprit->prints("is reloaded")) << culprit->output();
  TestRosNode third(options());
  auto& reloaded = third.hear("/culprit/status", kStatusType, Durability::kTransientLocal);
  EXPECT_TRUE(
      reloaded.wait_for_one([](const Json& status) { return status["components"].size() == 2; }));
  EXPECT_EQ(third.call("/culprit/pause", kPauseType, {{"author", "bob"}})["success"], true);
}

struct SecuredRosApi : RosApiLive {
  SecuredRosApi() {
    keys.add("/robot", ros2::TestKeystore::everything("/robot"));
    setenv("ROS_SECURITY_ENABLE", "true", 1);
    setenv("ROS_SECURITY_STRATEGY", "Enforce", 1);
    setenv("ROS_SECURITY_KEYSTORE", keys.path().c_str(), 1);
  }
  ~SecuredRosApi() override {
    for (const char* name : {"ROS_SECURITY_ENABLE", "ROS_SECURITY_STRATEGY",
                             "ROS_SECURITY_KEYSTORE", "ROS_SECURITY_ENCLAVE_OVERRIDE"})
      unsetenv(name);
  }
  ros2::TestKeystore keys;
};

// The output of `culprit policy` without the lines that contain `leave_out`.
std::string permissions_for(const TestWorld& world, const std::string& leave_out) {
  const std::string file = (world.folder() / "permissions.xml").string();
  TestProgram policy(world, {"culprit", "policy", world.write("allowed.rules", kRosApiRules),
                             "--format", "permissions", "-o", file});
  EXPECT_EQ(policy.wait(), 0) << policy.output();
  std::ifstream written(file);
  std::string all;
  for (std::string line; std::getline(written, line);) {
    if (leave_out.empty() || line.find(leave_out) == std::string::npos) all += line + "\n";
  }
  return all;
}

TEST_F(SecuredRosApi, WatchesWithThePermissionsOfAnOlderCulpritAndSaysWhatTheyLack) {
  keys.add("/culprit", permissions_for(world, "/culprit/status"));
  auto culprit = run();
  ASSERT_TRUE(culprit->prints("culprit status")) << culprit->output();
  EXPECT_THAT(culprit->output(), HasSubstr("culprit does not publish ~/status"));
  EXPECT_THAT(culprit->output(), HasSubstr("do the permissions of the enclave /culprit allow it?"));
  culprit->signal(SIGINT);
  EXPECT_EQ(culprit->wait(), 0);
}

TEST_F(SecuredRosApi, ObeysANodeThatHasKeys) {
  keys.add("/culprit", permissions_for(world, ""));
  auto culprit = run();
  ASSERT_TRUE(culprit->prints("culprit status")) << culprit->output();
  setenv("ROS_SECURITY_ENCLAVE_OVERRIDE", "/robot", 1);
  TestRosNode panel(options());
  EXPECT_EQ(panel.call("/culprit/pause", kPauseType, {{"author", "ann"}})["success"], true);
  // A stranger is not even heard.
  unsetenv("ROS_SECURITY_ENABLE");
  TestRosNode stranger(options());
  EXPECT_EQ(stranger.call("/culprit/resume", "culprit_msgs/srv/Resume", {{"author", "eve"}},
                          std::chrono::seconds(1)),
            nullptr);
}

}  // namespace
}  // namespace culprit::cli
