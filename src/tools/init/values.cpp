#include "init/values.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "base/name_grammar.h"
#include "base/tool_names.h"
#include "base/units.h"
#include "init/measures.h"

namespace culprit::init {
namespace {

using namespace std::chrono_literals;
using link::ValueCourse;

constexpr std::size_t kFewestNumbers = 30;
constexpr std::size_t kFewestTexts = 30;
constexpr std::size_t kMostSignals = 4;  // of a topic
constexpr Duration kShortestFrozen = 2s;
constexpr Duration kLongestFrozen = 60s;
constexpr std::size_t kRowsUntilFrozen = 5;
// All measurements() have a header.
constexpr const char* kFrame = "header.frame_id";

struct Measurement {
  std::string_view type;
  std::vector<std::string> fields;
  bool is_motion =
      false;  // numbers that stand still with the robot, however they jitter when it moves
};

// Beams of a scan in several directions, whether it has 60 of them or some thousand.
std::vector<std::string> beams() {
  std::vector<std::string> all;
  for (const int beam : {0, 30, 60, 90, 120, 150, 180, 240, 300, 360, 450, 540, 720, 900, 1080})
    all.push_back(fmt::format("ranges[{}]", beam));
  return all;
}

const std::vector<Measurement>& measurements() {
  static const std::vector<Measurement> kAll = {
      {"sensor_msgs/msg/LaserScan", beams()},
      {"sensor_msgs/msg/Imu",
       {"linear_acceleration.x", "linear_acceleration.y", "linear_acceleration.z",
        "angular_velocity.z"}},
      {"sensor_msgs/msg/Range", {"range"}},
      {"sensor_msgs/msg/MagneticField",
       {"magnetic_field.x", "magnetic_field.y", "magnetic_field.z"}},
      {"sensor_msgs/msg/NavSatFix", {"latitude", "longitude", "altitude"}},
      {"sensor_msgs/msg/FluidPressure", {"fluid_pressure"}},
      {"sensor_msgs/msg/Temperature", {"temperature"}},
      {"geometry_msgs/msg/WrenchStamped", {"wrench.force.x", "wrench.force.y", "wrench.force.z"}},
      {"nav_msgs/msg/Odometry",
       {"pose.pose.position.x", "pose.pose.position.y", "twist.twist.linear.x"},
       true}};
  return kAll;
}

const Measurement* measurement_of(const std::string& type) {
  const auto found = std::ranges::find(measurements(), type, &Measurement::type);
  return found == measurements().end() ? nullptr : &*found;
}

bool is_of_list(const std::string& field) { return field.ends_with(']'); }

bool is_always_finite(const ValueCourse& course) {
  return course.numbers >= kFewestNumbers && course.others == 0;
}

// Two of three changes of pure noise turn back, and few of a value that follows the robot.
bool jitters(const ValueCourse& course) {
  return 10 * course.changes >= 7 * course.numbers && 10 * course.turns >= 3 * course.changes;
}

// Such names need no escapes in a rule file. Others are unusual, and get no rule.
bool is_plain(const std::string& frame) {
  return !frame.empty() && std::ranges::all_of(frame, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '/' || c == '-' || c == '.';
  });
}

// At most kMostSignals of them, spread from the first to the last.
std::vector<std::string> spread(const std::vector<std::string>& all) {
  if (all.size() <= kMostSignals) return all;
  std::vector<std::string> some;
  for (std::size_t i = 0; i < kMostSignals; ++i)
    some.push_back(all[i * (all.size() - 1) / (kMostSignals - 1)]);
  return some;
}

class Values {
 public:
  Values(const RobotProfile& seen, Names& names) : seen_(seen), names_(names) {}

  std::vector<Part> parts() {
    for (const auto& each : seen_.robot.topics) {
      const std::string& topic = each.first;
      const auto courses = seen_.fields.find(topic);
      if (courses == seen_.fields.end() || each.second.publishers.size() != 1 ||
          is_topic_of_ros(topic) || !is_valid_topic_name(topic))
        continue;
      if (const Measurement* measured = measurement_of(each.second.type))
        rules_of(topic, *measured, courses->second);
    }
    return std::move(parts_);
  }

 private:
  using Courses = std::map<std::string, ValueCourse>;

  void rules_of(const std::string& topic, const Measurement& measured, const Courses& courses) {
    std::vector<std::string> finite, noisy;
    std::size_t longest_row = 1;
    for (const std::string& field : measured.fields) {
      const auto course = courses.find(field);
      if (course == courses.end() || !is_always_finite(course->second)) continue;
      finite.push_back(field);
      if (measured.is_motion || !jitters(course->second)) continue;
      noisy.push_back(field);
      longest_row = std::max(longest_row, course->second.longest_row);
    }
    const std::vector<std::string> fields = spread(noisy.empty() ? finite : noisy);
    const auto window = noisy.empty() ? std::nullopt : frozen_after(topic, longest_row);
    std::string text = of_numbers(topic, fields, window) + of_frame(topic, courses);
    if (!text.empty())
      parts_.push_back({.kind = Part::Kind::kValues, .subject = topic, .text = std::move(text)});
  }

  std::string of_numbers(const std::string& topic, const std::vector<std::string>& fields,
                         std::optional<Duration> window) {
    if (fields.empty()) return "";
    const std::string base = topic.substr(1);
    std::string text = fmt::format("# guess: {} numbers of {} were finite{}.\n", fields.size(),
                                   topic, window ? ", and changed up and down by themselves" : "");
    text += "# If they are no longer, a person is notified.\n";
    std::vector<std::string> names;
    for (const std::string& field : fields) {
      names.push_back(names_.take(base + "_" + field));
      text += fmt::format("SIGNAL {} TOPIC {} FIELD {}\n", names.back(), topic, field);
    }
    if (window)
      text += rule(base + "_frozen", "",
                   of_each("frozen({}, " + to_string(*window) + ")", names, " && "));
    text += rule(base + "_nan", " FOR 1s",
                 of_each("isnan({})", names, is_of_list(fields.front()) ? " && " : " || "));
    return text;
  }

  std::string of_frame(const std::string& topic, const Courses& courses) {
    const auto course = courses.find(kFrame);
    if (course == courses.end() || course->second.texts < kFewestTexts ||
        course->second.texts_differ || !is_plain(course->second.text))
      return "";
    const std::string& frame = course->second.text;
    const std::string signal = names_.take(topic.substr(1) + "_frame");
    return fmt::format(
               "# guess: all messages of {} were in the frame {}. If they are in another one, a "
               "person is notified.\nSIGNAL {} TOPIC {} FIELD {}\n",
               topic, frame, signal, topic, kFrame) +
           rule(topic.substr(1) + "_wrong_frame", " FOR 1s",
                fmt::format("{} != \"{}\"", signal, frame));
  }

  // Nothing: they stay the same for so long when all is well that nobody would wait for it.
  std::optional<Duration> frozen_after(const std::string& topic, std::size_t longest_row) const {
    const auto rhythm = seen_.rhythms.find(topic);
    if (rhythm == seen_.rhythms.end()) return std::nullopt;
    const Duration row = rhythm->second.longest_pause * static_cast<int>(longest_row);
    const Duration window = rounded_up(std::max<Duration>(kShortestFrozen, kRowsUntilFrozen * row));
    return window <= kLongestFrozen ? std::optional(window) : std::nullopt;
  }

  std::string rule(const std::string& name, const std::string& policies,
                   const std::string& trigger) {
    return fmt::format("RULE {}\n  POLICIES WARNING{} REPORT\n  TRIGGER {}\n", names_.take(name),
                       policies, trigger);
  }

  // "frozen(a, 2s) && frozen(b, 2s)"
  static std::string of_each(const std::string& call, const std::vector<std::string>& signals,
                             const std::string& junction) {
    std::string all;
    for (const std::string& each : signals)
      all += (all.empty() ? "" : junction) + fmt::format(fmt::runtime(call), each);
    return all;
  }

  const RobotProfile& seen_;
  Names& names_;
  std::vector<Part> parts_;
};

}  // namespace

std::set<std::string> fields_of_measurement(const std::string& type) {
  const Measurement* measured = measurement_of(type);
  if (measured == nullptr) return {};
  std::set<std::string> fields(measured->fields.begin(), measured->fields.end());
  fields.insert(kFrame);
  return fields;
}

std::vector<Part> values(const RobotProfile& seen, Names& names) {
  return Values(seen, names).parts();
}

}  // namespace culprit::init
