// Numbers that are not finite, do not change any more, or cannot be decoded.
#include <algorithm>
#include <array>

#include <fmt/core.h>

#include "bag_doctor/examined.h"
#include "doctor/wording.h"

namespace culprit::bag_doctor {
namespace {

using namespace std::chrono_literals;
using doctor::duration;
using doctor::Gravity;
using Kind = Symptom::Kind;

template <std::size_t N>
bool is_of(const std::array<std::string_view, N>& types, const TopicCourse& topic) {
  return std::ranges::find(types, topic.type) != types.end();
}

// A device that works seldom measures the same twice, and never for seconds.
bool is_noisy(const TopicCourse& topic) {
  constexpr std::array<std::string_view, 10> kTypes = {"sensor_msgs/msg/CompressedImage",
                                                       "sensor_msgs/msg/FluidPressure",
                                                       "sensor_msgs/msg/Image",
                                                       "sensor_msgs/msg/Imu",
                                                       "sensor_msgs/msg/LaserScan",
                                                       "sensor_msgs/msg/MagneticField",
                                                       "sensor_msgs/msg/MultiEchoLaserScan",
                                                       "sensor_msgs/msg/NavSatFix",
                                                       "sensor_msgs/msg/PointCloud2",
                                                       "sensor_msgs/msg/Range"};
  return is_of(kTypes, topic);
}

// A robot that stands still says the same again and again.
bool is_of_motion(const TopicCourse& topic) {
  return topic.type == "nav_msgs/msg/Odometry" || topic.type == "sensor_msgs/msg/JointState" ||
         topic.type.starts_with("geometry_msgs/msg/") ||
         topic.type.starts_with("ackermann_msgs/msg/");
}

// Its numbers are finite by definition. Other types mean "not measured" by NaN (BatteryState, NavSatFix, efforts of joints),
// or "nothing there" by infinity (Range, LaserScan).
bool is_finite_field(const TopicCourse& topic, const std::string& path) {
  if (path.find("covariance") != std::string::npos) return false;
  if (topic.type == "sensor_msgs/msg/JointState") return path.starts_with("position");
  return topic.type == "sensor_msgs/msg/Imu" || topic.type == "nav_msgs/msg/Odometry" ||
         topic.type.starts_with("geometry_msgs/msg/") ||
         topic.type.starts_with("ackermann_msgs/msg/");
}

void look_at_numbers(const TopicCourse& topic, Symptoms& all) {
  constexpr std::size_t kFewestBefore = 5;
  std::vector<std::string> names;
  const FieldCourse* first = nullptr;
  bool is_failure = false;
  for (const FieldCourse& field : topic.fields) {
    const bool must_be_finite = is_finite_field(topic, field.path);
    const bool was_finite = field.finite_before >= kFewestBefore;
    if (field.not_finite == 0 || field.path.find("covariance") != std::string::npos) continue;
    if (!must_be_finite && (!was_finite || field.path.ends_with(']'))) continue;
    names.push_back(field.path);
    is_failure = is_failure || (must_be_finite && was_finite);
    if (first == nullptr || field.longest_not_finite.from < first->longest_not_finite.from)
      first = &field;
  }
  if (first == nullptr) return;
  const Run& run = first->longest_not_finite;
  const bool lasts = run.to == topic.times.back();
  all.push_back(
      {.kind = Kind::kValue,
       .finding =
           {"D205",
            is_failure ? Gravity::kError : Gravity::kWarning,
            topic.name,
            fmt::format("{} {} NaN or infinite in {} of {} messages, {} of them in a row",
                        doctor::listed(names), names.size() == 1 ? "is" : "are", first->not_finite,
                        topic.times.size(), run.messages),
            "filters that take it in become NaN, too, and stay so; comparisons with it are false",
            "see what its publisher divides by, or what its device reports then",
            {},
            topic.name},
       .topic = topic.name,
       .onset = {first->finite_before == 0 ? kLongAgo : time_of(run.from), time_of(run.from)},
       .until = lasts ? kNever : time_of(run.to),
       .words = "published NaN on " + topic.name});
}

// Does it change with nearly every message, but for its longest row?
bool changes_by_habit(const FieldCourse& field) {
  constexpr std::size_t kFewest = 30;
  if (field.count < kFewest || field.longest.messages >= field.count) return false;
  const std::size_t rest = field.count - field.longest.messages;
  return rest >= kFewest && 10 * field.changes >= 9 * rest;
}

bool is_frozen(const FieldCourse& field) {
  constexpr std::size_t kFewest = 15;
  return changes_by_habit(field) &&
         field.longest.messages >= std::max(kFewest, 5 * field.second.messages) &&
         Duration(field.longest.to - field.longest.from) >= 2s;
}

bool moves_meanwhile(const FieldCourse& field, const Run& run) {
  if (!changes_by_habit(field)) return false;
  const Nanoseconds shared =
      std::min(field.longest.to, run.to) - std::max(field.longest.from, run.from);
  return 4 * shared < run.to - run.from;
}

bool moves_meanwhile(const TopicCourse& topic, const Run& run) {
  const bool is_there =
      !topic.times.empty() && topic.times.front() < run.to && topic.times.back() > run.from;
  return is_there && (moves_meanwhile(topic.content, run) ||
                      std::ranges::any_of(topic.fields, [&](const FieldCourse& field) {
                        return moves_meanwhile(field, run);
                      }));
}

void look_at_frozen(const TopicCourse& topic, const BagCourse& course, Symptoms& all) {
  std::vector<std::string> names;
  const FieldCourse* longest = nullptr;
  std::size_t changing = 0;
  const auto take = [&](const FieldCourse& field, const std::string& name) {
    changing += changes_by_habit(field) ? 1 : 0;
    if (!is_frozen(field)) return;
    names.push_back(name);
    if (longest == nullptr || field.longest.messages > longest->longest.messages) longest = &field;
  };
  if (topic.content.count > 0) {
    take(topic.content, "its content");
  } else {
    for (const FieldCourse& field : topic.fields) take(field, field.path);
  }
  if (longest == nullptr) return;
  const Run& run = longest->longest;
  const auto does_another_move = [&](auto is_it) {
    return std::ranges::any_of(course.topics, [&](const TopicCourse& other) {
      return &other != &topic && is_it(other) && moves_meanwhile(other, run);
    });
  };
  const bool robot_moves = does_another_move(is_of_motion);
  const bool others_measure = does_another_move(is_noisy);
  if (is_of_motion(topic) && !robot_moves && names.size() == changing) return;  // it stands still
  if (!does_another_move([](const TopicCourse&) { return true; })) return;
  // A number may stay while others of the topic change: a position that is rounded, or an axis at rest.
  const bool is_whole = topic.content.count > 0 || names.size() == changing;
  const bool is_failure = is_noisy(topic) && is_whole && (robot_moves || others_measure);
  all.push_back(
      {.kind = Kind::kValue,
       .finding =
           {"D206",
            is_failure ? Gravity::kError : Gravity::kWarning,
            topic.name,
            fmt::format("{} did not change for {} ({} messages); else it changes with nearly every "
                        "message, "
                        "and other topics went on changing",
                        doctor::listed(names), duration(Duration(run.to - run.from)), run.messages),
            "its readers take old data for new data",
            "see whether its publisher repeats its last reading when its device does not answer",
            {},
            topic.name},
       .topic = topic.name,
       .onset = {time_of(run.from), time_of(run.from)},
       .until = run.to == topic.times.back() ? kNever : time_of(run.to),
       .words = "froze on " + topic.name});
}

void look_at_decoding(const TopicCourse& topic, Symptoms& all) {
  if (topic.undecoded == 0 && topic.other_type_from == 0) return;
  const Nanoseconds from = topic.undecoded > 0 ? topic.undecoded_from : topic.other_type_from;
  const bool is_over = topic.undecoded > 0 && topic.undecoded_to != topic.times.back();
  const std::string seen = topic.undecoded > 0
                               ? fmt::format("{} of {} messages do not fit its type {}",
                                             topic.undecoded, topic.times.size(), topic.type)
                               : fmt::format("its type is {}, and later {}", topic.type,
                                             doctor::listed(topic.other_types));
  all.push_back(
      {.kind = Kind::kValue,
       .finding = {"D216",
                   Gravity::kWarning,
                   topic.name,
                   seen,
                   "their values are unknown, and a reader may refuse them",
                   "see whether all publishers were built with one version of the message package",
                   {},
                   topic.name},
       .topic = topic.name,
       .onset = {from == topic.times.front() ? kLongAgo : time_of(from), time_of(from)},
       .until = is_over ? time_of(topic.undecoded_to) : kNever,
       .words = "published messages of another type on " + topic.name});
}

}  // namespace

void look_at_values(const Examined& bag, Symptoms& all) {
  for (const JudgedTopic& each : bag.topics) {
    look_at_numbers(*each.topic, all);
    if (each.habit.is_known()) look_at_frozen(*each.topic, bag.course, all);
    look_at_decoding(*each.topic, all);
  }
}

}  // namespace culprit::bag_doctor
