#include "init/movement.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "base/name_grammar.h"
#include "base/tool_names.h"
#include "init/measures.h"

namespace culprit::init {
namespace {

constexpr double kStandstill = 0.01;  // m/s and rad/s

// Commands by their types, and where it is only by its name that one is known, by that.
struct Movement {
  std::string_view type;
  std::string_view name_ends = "";
  std::vector<std::string> speeds{};  // none: each command begins a movement of its own length
};

const std::vector<Movement>& movements() {
  static const std::vector<Movement> kAll = {
      {"geometry_msgs/msg/Twist", "", {"linear.x", "linear.y", "linear.z", "angular.z"}},
      {"geometry_msgs/msg/TwistStamped",
       "",
       {"twist.linear.x", "twist.linear.y", "twist.linear.z", "twist.angular.z"}},
      {"ackermann_msgs/msg/AckermannDrive", "", {"speed"}},
      {"ackermann_msgs/msg/AckermannDriveStamped", "", {"drive.speed"}},
      {"trajectory_msgs/msg/JointTrajectory"},
      {"control_msgs/msg/JointJog"},
      {"std_msgs/msg/Float64MultiArray", "/commands"}};
  return kAll;
}

const Movement* movement_of(const std::string& topic, const std::string& type) {
  const auto found = std::ranges::find_if(movements(), [&](const Movement& each) {
    return each.type == type && topic.ends_with(each.name_ends);
  });
  return found == movements().end() ? nullptr : &*found;
}

// "at most 0.3 while it was watched".
std::string measured(const std::map<std::string, link::ValueCourse>& fields) {
  double most = 0;
  std::size_t values = 0;
  for (const auto& each : fields) {
    if (each.second.numbers == 0) continue;
    most = std::max({most, std::abs(each.second.least), std::abs(each.second.most)});
    values = std::max(values, each.second.numbers);
  }
  if (values == 0) return "no command came";
  return fmt::format("{} commands came, at most {}", values, as_number(most));
}

}  // namespace

std::set<std::string> fields_of_movement(const std::string& type) {
  for (const Movement& each : movements()) {
    if (each.type == type) return {each.speeds.begin(), each.speeds.end()};
  }
  return {};
}

std::string interlocks_text(const RobotProfile& seen, Names& names) {
  std::string proposals;
  for (const auto& each : seen.robot.topics) {
    const std::string& topic = each.first;
    const Movement* movement = movement_of(topic, each.second.type);
    if (movement == nullptr || is_topic_of_ros(topic) || !is_valid_topic_name(topic)) continue;
    if (movement->speeds.empty()) {
      proposals += fmt::format(
          "# {0} ({1}): each command is taken to be done after 10s.\n"
          "#   INTERLOCK age({0}) > 10s\n",
          topic, each.second.type);
      continue;
    }
    const auto fields = seen.fields.find(topic);
    proposals += fmt::format(
        "# {} ({}): {}.\n", topic, each.second.type,
        measured(fields == seen.fields.end() ? std::map<std::string, link::ValueCourse>{}
                                             : fields->second));
    std::string speed;
    for (const std::string& field : movement->speeds) {
      const std::string name = names.take(topic + "_" + field);
      proposals += fmt::format("#   SIGNAL {} TOPIC {} FIELD {}\n", name, topic, field);
      speed += (speed.empty() ? "abs(" : " + abs(") + name + ")";
    }
    proposals += fmt::format("#   INTERLOCK age({}) > 1s || {} < {}\n", topic, speed, kStandstill);
  }
  if (proposals.empty()) return "";
  return "# proposal: begin no strategy while these command a movement. Remove the # from those "
         "that your robot obeys, and try it:\n"
         "# without their messages, no strategy begins either.\n" +
         proposals;
}

}  // namespace culprit::init
