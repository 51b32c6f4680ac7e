#include "bag_doctor/examined.h"

#include <algorithm>
#include <array>

#include "base/tool_names.h"
#include "doctor/stamped_types.h"

namespace culprit::bag_doctor {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kFewestTopics = 3;  // that say something of all

void find_shutdown(Examined& bag) {
  constexpr Duration kLongest = 5s;
  constexpr Duration kLongestAlone = 15s;
  bag.end = bag.course.end;
  std::vector<Nanoseconds> last;
  for (const JudgedTopic& each : bag.topics) {
    if (each.habit.is_steady) last.push_back(each.topic->times.back() + each.habit.usual.count());
  }
  if (last.size() < kFewestTopics) return;
  std::ranges::sort(last);
  // The recorder was stopped after all the others.
  if (last.back() > bag.end - kLongestAlone.count()) bag.end = std::min(bag.end, last.back());
  const Nanoseconds half = last[(last.size() - 1) / 2];
  if (half < bag.end && half > bag.end - kLongest.count()) bag.end = half;
}

// The part of the gap in which no topic has a message.
Stretch without_any(Stretch gap, const BagCourse& course) {
  for (const TopicCourse& topic : course.topics) {
    const auto behind = std::ranges::lower_bound(topic.times, (gap.from + gap.to) / 2);
    if (behind != topic.times.end()) gap.to = std::min(gap.to, *behind);
    if (behind != topic.times.begin()) gap.from = std::max(gap.from, *std::prev(behind));
  }
  return gap;
}

void find_holes(Examined& bag) {
  std::vector<const JudgedTopic*> steady;
  for (const JudgedTopic& each : bag.topics) {
    if (each.habit.is_steady) steady.push_back(&each);
  }
  if (steady.size() < kFewestTopics) return;
  for (const JudgedTopic* each : steady) {
    for (const Stretch& gap : each->habit.gaps) {
      const Stretch hole = without_any(gap, bag.course);
      const bool is_for_all = std::ranges::all_of(
          steady, [&](const JudgedTopic* other) { return hole.length() > 3 * other->habit.usual; });
      const bool is_known = std::ranges::any_of(
          bag.holes, [&](const Stretch& other) { return other.from == hole.from; });
      if (is_for_all && !is_known && hole.length() > kShortestGap) bag.holes.push_back(hole);
    }
  }
}

void find_other_clock(Examined& bag) {
  constexpr Duration kFarOff = 10s;
  std::vector<Duration> lags;
  for (const TopicCourse& topic : bag.course.topics) {
    if (topic.stamps.size() < kFewestMessages) continue;
    const std::size_t middle = topic.stamps.size() / 2;
    if (topic.stamps[middle] != 0) lags.emplace_back(topic.times[middle] - topic.stamps[middle]);
  }
  if (lags.empty()) return;
  std::ranges::sort(lags);
  const Duration middle = lags[lags.size() / 2];
  const bool is_simulated = counts_from_zero(bag.course.end - middle.count(), bag.course.end);
  if (lags.size() < 2 && !is_simulated) return;
  const auto agree = std::ranges::count_if(
      lags, [&](Duration lag) { return lag > middle - kFarOff && lag < middle + kFarOff; });
  if (std::chrono::abs(middle) <= kFarOff || 3 * agree < 2 * std::ssize(lags)) return;
  bag.other_clock = middle;
  bag.is_simulated = is_simulated;
}

}  // namespace

bool counts_from_zero(Nanoseconds stamp, Nanoseconds recorded) {
  constexpr Duration kLongest = 24h * 365 * 5;
  return Duration(stamp) < kLongest && Duration(recorded - stamp) > kLongest;
}

bool Examined::is_hole(const Stretch& gap, const Habit& habit) const {
  const bool is_of_copy = std::ranges::any_of(course.holes, [&](const BagCourse::Hole& hole) {
    return gap.from < hole.to && hole.from < gap.to;
  });
  return is_of_copy || std::ranges::any_of(holes, [&](const Stretch& hole) {
           return gap.from <= hole.from && hole.to <= gap.to &&
                  gap.length() - hole.length() < 3 * habit.usual + kShortestGap;
         });
}

Examined examined(const BagCourse& course) {
  Examined bag{course};
  for (const TopicCourse& each : course.topics) {
    const bool counts = !each.is_latched && !is_topic_of_ros(each.name);
    bag.topics.push_back({&each, counts ? habit_of(each.times) : Habit{}});
  }
  find_shutdown(bag);
  find_holes(bag);
  find_other_clock(bag);
  return bag;
}

bool is_continuous(const TopicCourse& topic) {
  constexpr std::array<std::string_view, 4> kMore = {
      "sensor_msgs/msg/JointState", "sensor_msgs/msg/MultiEchoLaserScan",
      "sensor_msgs/msg/RelativeHumidity", "sensor_msgs/msg/Temperature"};
  return doctor::is_sensor_type(topic.type) || std::ranges::find(kMore, topic.type) != kMore.end();
}

std::vector<Symptom> symptoms_of(const BagCourse& course) {
  const Examined bag = examined(course);
  Symptoms all;
  for (const auto look :
       {look_at_rhythm, look_at_values, look_at_stamps, look_at_frames, look_at_states})
    look(bag, all);
  std::ranges::stable_sort(all, {}, [](const Symptom& s) { return s.onset.latest; });
  return all;
}

std::vector<Health> healthy_topics(const BagCourse& course, const std::vector<Symptom>& symptoms) {
  std::vector<Health> healthy;
  for (const TopicCourse& topic : course.topics) {
    const bool is_ill =
        std::ranges::any_of(symptoms, [&](const Symptom& s) { return s.topic == topic.name; });
    if (is_ill || topic.times.size() < kFewestMessages || topic.is_latched) continue;
    healthy.push_back({topic.name, !topic.fields.empty() || topic.content.count > 0});
  }
  return healthy;
}

}  // namespace culprit::bag_doctor
