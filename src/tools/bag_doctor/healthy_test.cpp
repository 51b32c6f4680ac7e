// Recordings of robots that are well: nothing in them is an error, however their topics come.
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bag_doctor/bag_report.h"
#include "bag_doctor/test_recording.h"
#include "base/test_expected.h"
#include "base/test_folder.h"

namespace culprit::bag_doctor {
namespace {

using culprit::test::value_of;
using doctor::Gravity;
using test::noise;

class HealthyRecording : public testing::Test {
 protected:
  // A sensor at `rate` Hz, each message up to `jitter` pauses late.
  void sensor(const std::string& topic, double rate, double jitter = 0.1, double from = 0,
              double to = 60) {
    const std::size_t seed = std::hash<std::string>{}(topic);
    for (double i = 0; from + i / rate < to; ++i) {
      const double late = jitter / rate * (noise(seed + static_cast<std::size_t>(i)) + 0.5);
      const double time = from + i / rate + late;
      recording_.add(topic, "sensor_msgs/msg/Imu", time,
                     test::imu(time - 0.01, noise(seed + static_cast<std::size_t>(i))));
    }
  }
  // Numbers of no standard meaning.
  void number(const std::string& topic, double time) {
    recording_.add(topic, "std_msgs/msg/Float64", time, test::number(time, noise(count_++)));
  }

  std::vector<std::string> found(Gravity gravity) {
    ros2::MessageLibrary library;
    const BagReport report = report_of(
        value_of(read_course(recording_.write(folder_.path() / "bag.mcap"), library)), {});
    std::vector<std::string> codes;
    for (const auto& each : report.findings) {
      if (each.gravity >= gravity)
        codes.push_back(each.code + " " + each.subject + ": " + each.seen);
    }
    return codes;
  }
  void expect_nothing() { EXPECT_THAT(found(Gravity::kWarning), testing::IsEmpty()); }
  void expect_no_error() { EXPECT_THAT(found(Gravity::kError), testing::IsEmpty()); }

  const culprit::test::TestFolder folder_;
  test::Recording recording_;
  std::uint64_t count_ = 0;
};

TEST_F(HealthyRecording, WithSteadyTopics) {
  sensor("/imu", 100);
  sensor("/gps", 5);
  sensor("/scan_imu", 20);
  expect_nothing();
}

TEST_F(HealthyRecording, WithJitter) {
  sensor("/jittery", 10, 1.8);
  sensor("/calm", 50, 0.1);
  expect_nothing();
}

TEST_F(HealthyRecording, WithBursts) {
  sensor("/imu", 20);
  for (int burst = 0; burst < 12; ++burst) {
    for (int i = 0; i < 30; ++i) number("/burst", burst * 5 + i * 0.01);
  }
  expect_nothing();
}

TEST_F(HealthyRecording, WithFewLongBursts) {
  sensor("/imu", 20);
  for (int burst = 0; burst < 4; ++burst) {
    for (int i = 0; i < 100; ++i) number("/burst", burst * 15 + i * 0.02);
  }
  expect_no_error();
}

TEST_F(HealthyRecording, WithLatchedTopics) {
  sensor("/imu", 20);
  recording_.add("/map_saver/text", "std_msgs/msg/String", 0.1,
                 test::Payload().put_text("once").bytes());
  recording_.add("/tf_static", "tf2_msgs/msg/TFMessage", 0.2, test::transform(0, "base", "laser"));
  expect_nothing();
}

TEST_F(HealthyRecording, WithASlowTopic) {
  sensor("/imu", 20, 0.1, 0, 200);
  for (int i = 0; i < 20; ++i)
    number("/once_in_ten_seconds", 3 + 10 * i + noise(static_cast<std::uint64_t>(i)));
  expect_nothing();
}

TEST_F(HealthyRecording, WithASensorThatStartedLateByDesign) {
  sensor("/imu", 20);
  sensor("/late", 20, 0.1, 22);
  expect_no_error();
}

TEST_F(HealthyRecording, WithTopicsOnDemand) {
  sensor("/imu", 20);
  for (int i = 0; i < 200; ++i) {
    recording_.add("/cmd_vel", "geometry_msgs/msg/Twist", 10 + i * 0.05,
                   test::twist(0, noise(count_++)));
    recording_.add("/cmd_vel", "geometry_msgs/msg/Twist", 35 + i * 0.05,
                   test::twist(0, noise(count_++)));
  }
  recording_.announce("/goal_pose", "geometry_msgs/msg/PoseStamped");
  recording_.announce("/initialpose", "geometry_msgs/msg/PoseWithCovarianceStamped");
  expect_no_error();
}

// The nodes of a launch end one after the other, and the recorder last.
TEST_F(HealthyRecording, ThatEndsWithTheLaunch) {
  for (int i = 0; i < 5; ++i) sensor("/imu" + std::to_string(i), 20, 0.1, 0, 60 + 0.7 * i);
  expect_no_error();
}

// The recorder was stopped some seconds after the robot.
TEST_F(HealthyRecording, ThatEndsAfterTheRobot) {
  for (int i = 0; i < 5; ++i) sensor("/imu" + std::to_string(i), 20, 0.1, 0, 50 + 0.5 * i);
  recording_.add("/rosout", "rcl_interfaces/msg/Log", 60, test::log(60, 20, "recorder", "stopped"));
  expect_no_error();
}

// A marker is in sight for a while.
TEST_F(HealthyRecording, OfATransformThatIsThereForAWhile) {
  for (int i = 0; i < 5; ++i) sensor("/imu" + std::to_string(i), 20);
  for (int i = 100; i < 500; ++i)
    recording_.add("/tf", "tf2_msgs/msg/TFMessage", i * 0.05,
                   test::transform(i * 0.05, "camera", "marker_3"));
  expect_no_error();
}

// The recorder finds publishers one after the other.
TEST_F(HealthyRecording, HasItsTopicsFoundWithinSeconds) {
  for (int i = 0; i < 5; ++i) sensor("/imu" + std::to_string(i), 20, 0.1, 0.8 * i);
  expect_nothing();
}

TEST_F(HealthyRecording, OfARobotThatStandsStillForAWhile) {
  sensor("/imu", 50);
  for (int i = 0; i < 3000; ++i) {
    const double time = i * 0.02;
    const bool stands = time > 30 && time < 40;
    recording_.add("/odom", "nav_msgs/msg/Odometry", time,
                   test::odometry(time, stands ? 1 : std::sin(time) + noise(count_++) / 10));
  }
  expect_nothing();
}

// The computer was asleep for a while: that is no failure of a topic.
TEST_F(HealthyRecording, WithAHole) {
  for (const char* topic : {"/a", "/b", "/c"}) {
    sensor(topic, 20, 0.1, 0, 30);
    sensor(topic, 20, 0.1, 45, 60);
  }
  EXPECT_THAT(found(Gravity::kWarning),
              testing::ElementsAre(testing::StartsWith("D210 the recording")));
}

TEST_F(HealthyRecording, OfSimulatedTime) {
  for (int i = 0; i < 600; ++i) {
    for (const char* topic : {"/imu", "/imu2"})
      recording_.add(topic, "sensor_msgs/msg/Imu", i * 0.05,
                     test::imu(i * 0.05 - 1.6e9, noise(count_++)));
  }
  expect_nothing();
}

TEST_F(HealthyRecording, OfOneTopicInSimulatedTime) {
  for (int i = 0; i < 600; ++i)
    recording_.add("/imu", "sensor_msgs/msg/Imu", i * 0.05,
                   test::imu(i * 0.05 - 1.7e9, noise(count_++)));
  expect_nothing();
}

TEST_F(HealthyRecording, OfTwoPublishersWhoseStampsMix) {
  for (int i = 0; i < 1200; ++i) {
    const double time = i * 0.05;
    recording_.add("/joint_states_like", "sensor_msgs/msg/Imu", time,
                   test::imu(i % 2 == 0 ? time - 0.01 : time - 0.04 - 0.05, noise(count_++)));
  }
  expect_no_error();
}

TEST_F(HealthyRecording, WithDiagnosticsThatFailWhileTheRobotStarts) {
  sensor("/imu", 20);
  for (int i = 0; i < 60; ++i)
    recording_.add(
        "/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", i + 0.5,
        test::diagnostic(i, i < 3 ? 2 : 0, "camera: frames", i < 3 ? "no frame yet" : "ok"));
  expect_no_error();
}

TEST_F(HealthyRecording, WithALogOfErrorsThatDoNotMatter) {
  sensor("/imu", 20);
  recording_.add("/rosout", "rcl_interfaces/msg/Log", 12,
                 test::log(12, 40, "camera", "unknown parameter"));
  expect_no_error();
}

}  // namespace
}  // namespace culprit::bag_doctor
