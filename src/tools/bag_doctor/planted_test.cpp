// Faults planted in the recording of a robot with ten nodes: the doctor names the planted cause first.
#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bag_doctor/bag_report.h"
#include "bag_doctor/test_recording.h"
#include "base/test_expected.h"
#include "base/test_folder.h"

namespace culprit::bag_doctor {
namespace {

using culprit::test::value_of;

struct Part {
  std::string node;
  std::string topic;
  std::string type;
  double rate;
  std::string (*payload)(double stamp, double value);
  std::vector<std::string> needs;  // nodes
};

const std::vector<Part>& parts() {
  static const std::vector<Part> all = {
      {"/lidar", "/scan", "sensor_msgs/msg/LaserScan", 10, test::scan, {}},
      {"/imu_driver", "/imu", "sensor_msgs/msg/Imu", 25, test::imu, {}},
      {"/wheels", "/wheel_speed", "std_msgs/msg/Float64", 20, test::number, {}},
      {"/base", "/odom", "nav_msgs/msg/Odometry", 20, test::odometry, {"/wheels"}},
      {"/ekf",
       "/odometry/filtered",
       "nav_msgs/msg/Odometry",
       30,
       test::odometry,
       {"/base", "/imu_driver"}},
      {"/slam", "/pose", "geometry_msgs/msg/PoseStamped", 10, test::pose, {"/lidar", "/ekf"}},
      {"/planner", "/target", "geometry_msgs/msg/PoseStamped", 5, test::pose, {"/slam"}},
      {"/controller", "/cmd_vel", "geometry_msgs/msg/Twist", 20, test::twist, {"/planner", "/ekf"}},
      {"/thermometer", "/battery_temperature", "std_msgs/msg/Float64", 2, test::number, {}},
      {"/monitor", "/load", "std_msgs/msg/Float64", 1, test::number, {"/thermometer"}},
  };
  return all;
}

RobotGraph graph() {
  RobotGraph graph;
  for (const Part& part : parts()) {
    graph.nodes.insert(part.node);
    graph.publishers[part.topic].insert(part.node);
    for (const std::string& need : part.needs) {
      for (const Part& other : parts()) {
        if (other.node == need) graph.subscribers[other.topic].insert(part.node);
      }
    }
  }
  return graph;
}

enum class Fault {
  kSilence,
  kGap,
  kSlow,
  kNaN,
  kFrozen,
  kLate,
  kBack,
  kNeverBegan,
  kDeactivated,
  kFatal
};
constexpr std::array kFaults = {Fault::kSilence,     Fault::kGap,  Fault::kSlow, Fault::kNaN,
                                Fault::kFrozen,      Fault::kLate, Fault::kBack, Fault::kNeverBegan,
                                Fault::kDeactivated, Fault::kFatal};

constexpr double kLength = 45, kFrom = 20;

// How a component is hit: itself, or by something that it needs, one step later for each step.
struct Hit {
  Fault fault;
  double from;
  bool is_origin;
};

std::map<std::string, Hit> hits(Fault fault, const std::string& origin) {
  std::map<std::string, Hit> all = {{origin, {fault, kFrom, true}}};
  const bool spreads = fault != Fault::kLate && fault != Fault::kBack && fault != Fault::kFrozen;
  for (bool grows = spreads; grows;) {
    grows = false;
    for (const Part& part : parts()) {
      for (const std::string& need : part.needs) {
        if (!all.contains(need) || all.contains(part.node)) continue;
        const Hit& cause = all.at(need);
        all[part.node] = {fault, cause.from + 0.05, false};
        grows = true;
      }
    }
  }
  return all;
}

bool is_sent(const Hit& hit, double time, std::size_t number) {
  switch (hit.fault) {
    case Fault::kSilence:
    case Fault::kDeactivated:
    case Fault::kFatal:
      return time < hit.from;
    case Fault::kGap:
      return time < hit.from || time > hit.from + 12;
    case Fault::kSlow:
      return time < hit.from || number % 2 == 0;
    case Fault::kNeverBegan:
      return false;
    default:
      return true;
  }
}

void record(const Part& part, const Hit* hit, test::Recording& recording) {
  recording.announce(part.topic, part.type);
  const std::size_t seed = std::hash<std::string>{}(part.topic);
  double last = 0;
  for (std::size_t i = 0; static_cast<double>(i) / part.rate < kLength; ++i) {
    const double time =
        static_cast<double>(i) / part.rate + 0.001 + 0.2 / part.rate * test::noise(seed + i);
    const bool is_hit = hit != nullptr && time >= hit->from;
    if (hit != nullptr && !is_sent(*hit, time, i)) continue;
    double stamp = time - 0.01, value = std::sin(time / 7) + test::noise(seed + i) / 10;
    if (is_hit && hit->fault == Fault::kNaN) value = std::numeric_limits<double>::quiet_NaN();
    if (is_hit && hit->fault == Fault::kFrozen) value = last;
    if (is_hit && hit->fault == Fault::kLate) stamp -= 2;
    if (is_hit && hit->fault == Fault::kBack) stamp -= 1.5;
    last = value;
    recording.add(part.topic, part.type, std::max(time, 0.0), part.payload(stamp, value));
  }
  if (hit == nullptr || !hit->is_origin) return;
  if (hit->fault == Fault::kDeactivated) {
    recording.add(part.node + "/transition_event", "lifecycle_msgs/msg/TransitionEvent", hit->from,
                  test::transition("deactivating", "inactive"));
  }
  if (hit->fault == Fault::kFatal) {
    recording.add("/rosout", "rcl_interfaces/msg/Log", hit->from,
                  test::log(hit->from, 50, part.node.substr(1), "the device is gone"));
  }
}

BagReport report_of_robot(const std::map<std::string, Hit>& hits, const std::filesystem::path& path,
                          const RobotGraph& known) {
  test::Recording recording;
  for (const Part& part : parts()) {
    const auto hit = hits.find(part.node);
    record(part, hit == hits.end() ? nullptr : &hit->second, recording);
  }
  ros2::MessageLibrary library;
  return report_of(value_of(read_course(recording.write(path), library)), known);
}

std::string text_of(const BagReport& report) {
  std::string text;
  for (const auto& each : report.findings)
    text += doctor::label(each.gravity) + " " + each.code + " " + each.subject + ": " + each.seen +
            " " + to_string(*each.when) + "\n";
  for (const auto& each : report.left_out) text += each + "\n";
  return text;
}

// Stamps need a header, and some numbers are neither finite by definition nor watched before they are needed.
bool applies(Fault fault, const Part& part) {
  const bool has_header =
      part.type != "std_msgs/msg/Float64" && part.type != "geometry_msgs/msg/Twist";
  const bool has_numbers = part.type != "sensor_msgs/msg/LaserScan";
  const bool is_sensor = part.type == "sensor_msgs/msg/LaserScan" ||
                         part.type == "sensor_msgs/msg/Imu" || part.type == "nav_msgs/msg/Odometry";
  switch (fault) {
    case Fault::kLate:
    case Fault::kBack:
      return has_header;
    case Fault::kNaN:
      return has_numbers;
    case Fault::kNeverBegan:
      return is_sensor;  // of others nobody knows whether they had to come
    default:
      return true;
  }
}

TEST(Planted, TheCauseIsNamedFirstWhereTheGraphIsKnown) {
  const culprit::test::TestFolder folder;
  int tried = 0, named = 0;
  std::string missed;
  for (const Fault fault : kFaults) {
    for (const Part& part : parts()) {
      if (!applies(fault, part)) continue;
      ++tried;
      const BagReport report =
          report_of_robot(hits(fault, part.node), folder.path() / "robot.mcap", graph());
      const bool is_named = !report.findings.empty() && !report.findings.front().nodes.empty() &&
                            report.findings.front().nodes.front() == part.node;
      named += is_named ? 1 : 0;
      if (!is_named)
        missed += "fault " + std::to_string(static_cast<int>(fault)) + " at " + part.node + ":\n" +
                  text_of(report);
    }
  }
  EXPECT_GE(named * 100, tried * 95) << named << " of " << tried << "\n" << missed;
}

TEST(Planted, TheRobotThatIsWellHasNoFinding) {
  const culprit::test::TestFolder folder;
  const BagReport report = report_of_robot({}, folder.path() / "robot.mcap", graph());
  EXPECT_THAT(report.findings, testing::IsEmpty()) << text_of(report);
}

}  // namespace
}  // namespace culprit::bag_doctor
