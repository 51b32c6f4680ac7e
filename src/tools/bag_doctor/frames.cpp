// Transforms in the recording: frames with two parents, transforms that stop or are too old.
#include <algorithm>
#include <map>

#include <fmt/core.h>

#include "bag_doctor/examined.h"
#include "base/name_grammar.h"
#include "doctor/wording.h"

namespace culprit::bag_doctor {
namespace {

using namespace std::chrono_literals;
using doctor::duration;
using doctor::Gravity;
using Kind = Symptom::Kind;

std::string edge_of(const TransformCourse& edge) {
  return printable(edge.parent) + " → " + printable(edge.child);
}

// One that took over from the other does not overlap with it.
bool overlap(const TransformCourse& a, const TransformCourse& b) {
  return a.is_static || b.is_static ||
         (a.times.front() < b.times.back() && b.times.front() < a.times.back());
}

void look_for_two_parents(const BagCourse& course, Symptoms& all) {
  std::map<std::string, const TransformCourse*> first;  // by child
  for (const TransformCourse& each : course.transforms) {
    const auto [found, is_new] = first.try_emplace(each.child, &each);
    const TransformCourse& other = *found->second;
    if (is_new || other.parent == each.parent || !overlap(other, each)) continue;
    const Time since = time_of(std::max(other.times.front(), each.times.front()));
    all.push_back(
        {.kind = Kind::kValue,
         .finding = {"D052",
                     Gravity::kError,
                     "tf: " + printable(each.child),
                     "it has two parents: " + printable(other.parent) + " and " +
                         printable(each.parent),
                     "tf keeps what came last, so the tree falls apart and together all the time",
                     "switch one of their publishers off (publish_tf), or rename a frame",
                     {},
                     "/tf"},
         .topic = "/tf",
         .onset = {since, since},
         .words = "published a second parent of " + printable(each.child)});
  }
}

// Transforms of one publisher stop together: one finding for all of them.
struct Stopped {
  std::vector<std::string> edges;
  bool carries_others = false;  // other frames hang below one of them
  Nanoseconds last = 0;
  Habit habit;
};

void look_for_stopped(const Examined& bag, Symptoms& all) {
  std::vector<Stopped> stopped;
  for (const TransformCourse& edge : bag.course.transforms) {
    if (edge.is_static) continue;
    const Habit habit = habit_of(edge.times);
    const Nanoseconds last = edge.times.back();
    const Duration silent(bag.end - last);
    if (!habit.is_steady || silent <= std::max<Duration>(3s, 10 * habit.usual) ||
        silent <= 4 * habit.longest)
      continue;
    const auto same = std::ranges::find_if(stopped, [&](const Stopped& each) {
      return std::chrono::abs(Duration(each.last - last)) < each.habit.usual;
    });
    // A frame without others below may be that of a marker or an object, which is in sight now and then.
    const bool carries_others = std::ranges::any_of(
        bag.course.transforms,
        [&](const TransformCourse& other) { return other.parent == edge.child; });
    if (same == stopped.end()) {
      stopped.push_back({{edge_of(edge)}, carries_others, last, habit});
    } else {
      same->edges.push_back(edge_of(edge));
      same->carries_others = same->carries_others || carries_others;
    }
  }
  for (const Stopped& each : stopped)
    all.push_back(
        {.kind = Kind::kOutage,
         .finding =
             {"D051",
              each.carries_others ? Gravity::kError : Gravity::kWarning,
              "tf: " + doctor::listed(each.edges),
              fmt::format(
                  "the last one came {} before the recording ended; until then one came every {}",
                  duration(Duration(bag.course.end - each.last)), duration(each.habit.usual)),
              "a node that asks for it waits or gets an error",
              "see the log of its publisher at that time",
              {},
              "/tf"},
         .topic = "/tf",
         .onset = {time_of(each.last),
                   time_of(each.last) + std::max(each.habit.usual, each.habit.longest)},
         .words = "stopped the transform " + doctor::listed(each.edges)});
}

void look_for_old(const Examined& bag, Symptoms& all) {
  constexpr Duration kOld = 1s;
  for (const TransformCourse& edge : bag.course.transforms) {
    if (edge.is_static || edge.times.size() < kFewestMessages) continue;
    std::vector<Duration> lags;
    for (std::size_t i = 0; i < edge.times.size(); ++i)
      lags.push_back(Duration(edge.times[i] - edge.stamps[i]) - bag.other_clock);
    std::ranges::nth_element(lags, lags.begin() + std::ssize(lags) / 2);
    const Duration middle = lags[lags.size() / 2];
    if (middle < kOld) continue;
    all.push_back(
        {.kind = Kind::kValue,
         .finding = {"D051",
                     Gravity::kWarning,
                     "tf: " + edge_of(edge),
                     fmt::format("its stamps are {} old when they are recorded", duration(middle)),
                     "a node that asks for it now waits or gets an error",
                     "see what delays it, or set the clock of its computer",
                     {},
                     "/tf"},
         .topic = "/tf",
         .onset = {kLongAgo, time_of(bag.course.begin)},
         .words = "published the old transform " + edge_of(edge)});
  }
}

}  // namespace

void look_at_frames(const Examined& bag, Symptoms& all) {
  look_for_two_parents(bag.course, all);
  look_for_stopped(bag, all);
  look_for_old(bag, all);
}

}  // namespace culprit::bag_doctor
