// Topics that do not come, come late, or come more slowly than they did.
#include <algorithm>

#include <fmt/core.h>

#include "bag_doctor/examined.h"
#include "doctor/wording.h"

namespace culprit::bag_doctor {
namespace {

using namespace std::chrono_literals;
using doctor::duration;
using doctor::Finding;
using doctor::Gravity;
using Kind = Symptom::Kind;

std::string in_hertz(Duration pause) { return fmt::format("{:.3g} Hz", 1 / seconds(pause)); }

Onset onset_behind(Nanoseconds last, const Habit& habit) {
  return {time_of(last), time_of(last) + std::max(habit.usual, habit.longest)};
}

Finding about(const TopicCourse& topic, const char* code, Gravity gravity, std::string seen,
              std::string matters, std::string remedy) {
  return {code, gravity,   topic.name, std::move(seen), std::move(matters), std::move(remedy),
          {},   topic.name};
}

void report_hole(const Stretch& hole, Symptoms& all) {
  all.push_back(
      {.kind = Kind::kWords,
       .finding =
           {"D210", Gravity::kWarning, "the recording",
            fmt::format("it has no message of any topic for {}", duration(hole.length())),
            "the recorder, its disk or the whole computer stood still; nothing is known of the "
            "robot meanwhile",
            "see the recorder's log for dropped messages, and the computer's for a sleep or a "
            "full disk"},
       .onset = {time_of(hole.from), time_of(hole.from)},
       .until = time_of(hole.to)});
}

void report_jump(const BagCourse::Jump& jump, Symptoms& all) {
  const Duration by(std::abs(jump.by));
  all.push_back(
      {.kind = Kind::kWords,
       .finding =
           {"D209", Gravity::kWarning, "the clock",
            fmt::format("it was set {} by {} while the robot was recorded; times here go on as if "
                        "it were not",
                        jump.by < 0 ? "back" : "forward", duration(by)),
            "ages, rates and transforms of the robot were wrong by as much at that time",
            "set the clock before the robot starts, and let chrony or PTP slew it afterwards"},
       .onset = {time_of(jump.at), time_of(jump.at)},
       .until = time_of(jump.at)});
}

void look_at_absence(const TopicCourse& topic, const BagCourse& course, Symptoms& all) {
  // Goals, commands and plans come on demand; plugins of image_transport fit few images.
  if (!is_continuous(topic)) return;
  for (const char* plugin : {"/compressedDepth", "/theora", "/zstd", "/ffmpeg"}) {
    if (topic.name.ends_with(plugin)) return;
  }
  all.push_back(
      {.kind = Kind::kOutage,
       .finding =
           about(topic, "D203", Gravity::kWarning, "it was announced, and no message was recorded",
                 "its publisher was there; its device, its input or its configuration failed "
                 "before the recording began",
                 "see the log of its publisher, and whether the topics that it reads have "
                 "messages"),
       .topic = topic.name,
       .onset = {kLongAgo, time_of(course.begin)},
       .words = "published nothing on " + topic.name});
}

void look_at_gap(const JudgedTopic& judged, const Stretch& gap, Symptoms& all) {
  const TopicCourse& topic = *judged.topic;
  const Habit& habit = judged.habit;
  const bool stands_out = gap.length() > 4 * habit.longest;
  if (!habit.is_steady && !stands_out) return;
  const bool is_failure = habit.is_steady && is_continuous(topic) && habit.gaps.size() == 1 &&
                          stands_out &&
                          gap.length() > std::max<Duration>(2s, 4 * kGap * habit.usual);
  all.push_back(
      {.kind = Kind::kOutage,
       .finding = about(
           topic, "D201", is_failure ? Gravity::kError : Gravity::kWarning,
           fmt::format(
               "it paused for {}; usually it comes every {}, and its longest other pause is {}",
               duration(gap.length()), duration(habit.usual), duration(habit.longest)),
           "its readers had no data meanwhile, or worked with old data",
           "see the log of its publisher at that time"),
       .topic = topic.name,
       .onset = onset_behind(gap.from, habit),
       .until = time_of(gap.to),
       .words = "fell silent on " + topic.name});
}

void look_at_end(const JudgedTopic& judged, const Examined& bag, Symptoms& all) {
  const TopicCourse& topic = *judged.topic;
  const Habit& habit = judged.habit;
  const Nanoseconds last = topic.times.back();
  const Duration silent(bag.end - last);
  if (!habit.is_steady || silent <= habit.patience()) return;
  // A command or a plan that ends has done its work, mostly.
  const bool is_failure = is_continuous(topic) && silent > 4 * habit.longest &&
                          silent > std::max<Duration>(2s, 2 * kGap * habit.usual);
  all.push_back(
      {.kind = Kind::kOutage,
       .finding = about(
           topic, "D202", is_failure ? Gravity::kError : Gravity::kWarning,
           fmt::format(
               "its last message came {} before the recording ended; until then it came every {}",
               duration(Duration(bag.course.end - last)), duration(habit.usual)),
           "its publisher, or a component that it needs, failed or was ended",
           "see the log of its publisher at that time, and whether its process was still there"),
       .topic = topic.name,
       .onset = onset_behind(last, habit),
       .words = "fell silent on " + topic.name});
}

void look_at_pace(const JudgedTopic& judged, Symptoms& all) {
  const TopicCourse& topic = *judged.topic;
  for (const Habit::Slow& slow : judged.habit.slow) {
    all.push_back(
        {.kind = Kind::kOutage,
         .finding =
             about(topic, "D204", Gravity::kWarning,
                   fmt::format("its rate fell from {} to {} for {}", in_hertz(judged.habit.fast),
                               in_hertz(slow.pause), duration(slow.stretch.length())),
                   "its readers have less data than usual, and older data",
                   "see whether its publisher or the computer was busy then, or an exposure "
                   "became longer"),
         .topic = topic.name,
         .onset = {time_of(slow.stretch.from), time_of(slow.stretch.from) + 20 * slow.pause},
         .until = time_of(slow.stretch.to),
         .words = "slowed down on " + topic.name});
  }
}

void look_at_start(const JudgedTopic& judged, const BagCourse& course, Symptoms& all) {
  constexpr Duration kLate = 5s;  // recorders need some seconds to find all publishers
  const TopicCourse& topic = *judged.topic;
  const Duration late(topic.times.front() - course.begin);
  if (!is_continuous(topic) || !judged.habit.is_steady || late <= kLate + 2 * judged.habit.usual)
    return;
  all.push_back(
      {.kind = Kind::kOutage,
       .finding = about(
           topic, "D215", Gravity::kWarning,
           fmt::format("its first message came {} after the recording began; then it came every {}",
                       duration(late), duration(judged.habit.usual)),
           "its readers had nothing until then, unless it was started late by design",
           "see when its publisher was started, and what it waited for"),
       .topic = topic.name,
       .onset = {kLongAgo, time_of(course.begin)},
       .until = time_of(topic.times.front()),
       .words = "was silent at first on " + topic.name});
}

}  // namespace

void look_at_rhythm(const Examined& bag, Symptoms& all) {
  for (const BagCourse::Jump& jump : bag.course.jumps) report_jump(jump, all);
  for (const Stretch& hole : bag.holes) report_hole(hole, all);
  for (const JudgedTopic& each : bag.topics) {
    if (each.topic->times.empty()) {
      look_at_absence(*each.topic, bag.course, all);
      continue;
    }
    if (!each.habit.is_known()) continue;
    for (const Stretch& gap : each.habit.gaps) {
      if (!bag.is_hole(gap, each.habit)) look_at_gap(each, gap, all);
    }
    look_at_end(each, bag, all);
    look_at_pace(each, all);
    look_at_start(each, bag.course, all);
  }
}

}  // namespace culprit::bag_doctor
