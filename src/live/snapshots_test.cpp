// culprit asks a recorder for a snapshot of each incident, over DDS, by its ROS 2 service.
#include "live/snapshots.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "language/checker.h"
#include "plan/bayes/bayes_planner.h"
#include "ros2/live_test.h"
#include "ros2/service_server.h"
#include "ros2/services.h"

namespace culprit::live {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kHotRules = R"(
ROBOT rover
COMPONENT motor NODE /motor LAUNCH "motor"
SIGNAL heat TOPIC /heat FIELD data
RULE Hot
  POLICIES ERROR
  TRIGGER heat > 80
    STRATEGY redeploy 50 10
      ADAPTATION motor redeploy 3
)";

// A manager that receives the motor's temperature, and its observer.
struct HotRobot {
  HotRobot() {
    snapshots.joined(node);
    snapshots.begins(*manager, {}, Time());
  }
  ~HotRobot() { snapshots.leaves(); }
  // For a second.
  void is(double heat) {
    now += 1s;
    std::vector<Observation> observations{{now, SignalRead{SignalId(0), Value(heat)}}};
    const auto commands = manager->step(now, observations);
    snapshots.stepped({now, {}, observations, commands, manager->events()});
  }
  void is(double heat, int seconds) {
    for (int i = 0; i < seconds; ++i) is(heat);
  }
  bool says(const char* text) {
    return said.wait_for_one(
        [&](const std::string& each) { return each.find(text) != std::string::npos; });
  }

  const ros2::TestDomain domain;
  ros2::LiveContext context{domain.options()};
  ros2::NodeEntry node{*context, {"/", "culprit"}};
  const RuleSet rules = *check(Source("test", kHotRules)).rules;
  std::optional<Manager> manager{std::in_place, rules, std::make_unique<BayesPlanner>(),
                                 Manager::Options()};
  Time now{1h};  // of a computer that was started before
  rtps::EventLog<std::string> said;
  Snapshots snapshots{{.recorder = "/rosbag2_recorder",
                       .say = [this](const std::string& text) { said.add(text); }}};
};

// `ros2 bag record --snapshot-mode`, as far as it is asked.
struct RecorderOfAnotherOne {
  explicit RecorderOfAnotherOne(const ros2::TestDomain& domain, bool writes = true)
      : context(domain.options()),
        server(std::move(*ros2::ServiceServer::create(
            node, {"/rosbag2_recorder/snapshot", std::string(ros2::srv::Snapshot::kType)},
            rtps::qos::kServices, [this, writes](rtps::ByteView) {
              asked.add(0);
              return rtps::encode(ros2::srv::Snapshot::Response{writes});
            }))) {}
  rtps::EventLog<int> asked;
  ros2::LiveContext context;
  ros2::NodeEntry node{*context, {"/", "rosbag2_recorder"}};
  std::unique_ptr<ros2::ServiceServer> server;
};

TEST(Snapshots, AreWrittenOfWhatLedToAFailureAndOfWhatCameAfterIt) {
  HotRobot robot;
  RecorderOfAnotherOne recorder(robot.domain);
  robot.is(20, 3);
  robot.is(90, 3);
  ASSERT_TRUE(robot.says("/rosbag2_recorder/snapshot wrote a snapshot (Hot is detected)"));
  robot.is(20, 9);
  EXPECT_EQ(recorder.asked.all().size(), 1u) << "what comes after is not over yet";
  robot.is(20, 3);
  ASSERT_TRUE(robot.says("wrote a snapshot (after Hot)"));
  robot.is(20, 60);
  EXPECT_EQ(recorder.asked.all().size(), 2u);
}

TEST(Snapshots, OfAFailureThatComesAndGoesAreFew) {
  HotRobot robot;
  RecorderOfAnotherOne recorder(robot.domain);
  for (int i = 0; i < 15; ++i) {
    robot.is(90);
    robot.is(20);
  }
  robot.is(20, 12);
  ASSERT_TRUE(robot.says("(after Hot)"));
  EXPECT_LE(recorder.asked.all().size(), 5u) << "in 42 s, with 10 s after each";
}

TEST(Snapshots, OfARecorderThatIsNotThereAreMissedBeforeTheyAreNeeded) {
  HotRobot robot;
  robot.is(20, 9);
  EXPECT_THAT(robot.said.all(), IsEmpty()) << "it may still be discovered";
  robot.is(20, 3);
  EXPECT_THAT(robot.said.all(),
              ElementsAre(HasSubstr("no node offers /rosbag2_recorder/snapshot")));
  // A recorder that is started in time gets the requests.
  robot.is(90);
  RecorderOfAnotherOne recorder(robot.domain);
  EXPECT_TRUE(robot.says("wrote a snapshot (Hot is detected)"));
}

TEST(Snapshots, ThatARecorderRefusesAreSaidToBeMissing) {
  HotRobot robot;
  RecorderOfAnotherOne recorder(robot.domain, false);
  robot.is(90);
  EXPECT_TRUE(robot.says("no snapshot (Hot is detected): /rosbag2_recorder/snapshot refused it"));
}

}  // namespace
}  // namespace culprit::live
