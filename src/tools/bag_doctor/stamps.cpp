// Header stamps that lag behind, lead, go back or repeat, each beside the topic's own habit.
//
// The lag of a message is the recorder's time less its stamp. Its habit is between the 20th and the 80th percentile; what
// lies beyond the other ends (the second and the 98th) by five times as much as these do is none of it.
#include <algorithm>
#include <optional>

#include <fmt/core.h>

#include "bag_doctor/examined.h"
#include "doctor/wording.h"

namespace culprit::bag_doctor {
namespace {

using namespace std::chrono_literals;
using doctor::duration;
using doctor::Gravity;
using Kind = Symptom::Kind;

constexpr Duration kOld = 1s;
constexpr Duration kAhead = 2s;
constexpr std::size_t kFewestInRow = 5;

struct Stamped {
  std::vector<Nanoseconds> times, stamps;
  std::vector<Duration> lags;
  Run without{};  // the longest row of messages without a stamp, after some that had one
};

// Without those that have none.
Stamped stamped(const TopicCourse& topic, Duration other_clock) {
  Stamped all;
  Run without;
  for (std::size_t i = 0; i < std::min(topic.times.size(), topic.stamps.size()); ++i) {
    if (topic.stamps[i] == 0) {
      if (all.stamps.empty()) continue;
      if (without.messages++ == 0) without.from = topic.times[i];
      without.to = topic.times[i];
      if (without.messages > all.without.messages) all.without = without;
      continue;
    }
    without = {};
    all.times.push_back(topic.times[i]);
    all.stamps.push_back(topic.stamps[i]);
    all.lags.push_back(Duration(topic.times[i] - topic.stamps[i]) - other_clock);
  }
  return all;
}

Duration lag_at(std::vector<Duration> lags, double share) {
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(lags.size() - 1));
  std::nth_element(lags.begin(), lags.begin() + place, lags.end());
  return lags[static_cast<std::size_t>(place)];
}

class StampLook {
 public:
  StampLook(const TopicCourse& topic, const Stamped& all, const Examined& bag, Symptoms& symptoms)
      : topic_(topic), all_(all), bag_(bag), course_(bag.course), symptoms_(symptoms) {}

  void look() {
    for (std::size_t i = 0; i < all_.stamps.size(); ++i) {
      const bool is_from_zero = counts_from_zero(all_.stamps[i], all_.times[i]);
      clock_changes_ += i > 0 && is_from_zero != is_from_zero_ ? 1 : 0;
      is_from_zero_ = is_from_zero;
    }
    if (clock_changes_ > kMostClockChanges) return report_mixed_clocks();
    look_back();
    look_at_missing();
    const bool repeats = look_at_repeats();
    const Duration base = lag_at(all_.lags, 0.2);
    if (base > kOld) return is_from_zero_ ? report_unset_clock() : report_old(base);
    if (base < -kAhead)
      return bag_.is_simulated && !is_from_zero_ ? report_real_clock() : report_ahead(base);
    if (!repeats) look_at_stretches(base, lag_at(all_.lags, 0.8));
  }

 private:
  void add(const char* code, Gravity gravity, std::string seen, std::string matters,
           std::string remedy, Onset onset, Time until, std::string words) {
    symptoms_.push_back({.kind = Kind::kValue,
                         .finding = {code,
                                     gravity,
                                     topic_.name,
                                     std::move(seen),
                                     std::move(matters),
                                     std::move(remedy),
                                     {},
                                     topic_.name},
                         .topic = topic_.name,
                         .onset = onset,
                         .until = until,
                         .words = std::move(words) + topic_.name});
  }
  Onset always() const { return {kLongAgo, time_of(course_.begin)}; }

  // Two publishers of one topic mix their stamps all the time, by little: that is no jump.
  void look_back() {
    constexpr Duration kLittle = 20ms, kMuch = 1s;
    std::size_t count = 0;
    std::optional<std::size_t> first;
    Duration furthest{};
    for (std::size_t i = 1; i < all_.stamps.size(); ++i) {
      const Duration back(all_.stamps[i - 1] - all_.stamps[i]);
      if (back <= kLittle) continue;
      ++count;
      if (!first) first = i;
      furthest = std::max(furthest, back);
    }
    if (!first || (20 * count > all_.stamps.size() && furthest < kMuch)) return;
    const bool is_failure = furthest > kMuch || (count <= 3 && furthest > 100ms);
    add("D044", is_failure ? Gravity::kError : Gravity::kWarning,
        fmt::format("its time stamps jumped back {}, by {} at most",
                    count == 1 ? "once" : doctor::count_of(count, "time"), duration(furthest)),
        "tf drops its history or later messages, and filters start again",
        "see whether a clock was set meanwhile (chrony, PTP), or two publishers use this topic",
        {time_of(all_.times[*first]), time_of(all_.times[*first])}, time_of(all_.times[*first]),
        "stamped back in time on ");
  }

  // To a reader, a stamp of zero is one of 1970.
  void look_at_missing() {
    const Run& run = all_.without;
    if (run.messages < kFewestInRow || Duration(run.to - run.from) < 1s) return;
    add("D044", Gravity::kError,
        fmt::format("its time stamps became zero, for {} ({} messages)",
                    duration(Duration(run.to - run.from)), run.messages),
        "tf drops its history or later messages, and filters start again",
        "see whether its publisher lost its clock: /clock with use_sim_time, or the device's own",
        {time_of(run.from), time_of(run.from)},
        run.to == topic_.times.back() ? kNever : time_of(run.to), "stamped with zero on ");
  }

  bool look_at_repeats() {
    Run row{}, longest{};
    std::size_t repeats = 0;
    for (std::size_t i = 0; i < all_.stamps.size(); ++i) {
      const bool is_same = i > 0 && all_.stamps[i] == all_.stamps[i - 1];
      repeats += is_same ? 1 : 0;
      row = is_same ? Run{row.from, all_.times[i], row.messages + 1}
                    : Run{all_.times[i], all_.times[i], 1};
      if (row.messages > longest.messages) longest = row;
    }
    if (repeats_in_stretch(repeats)) return true;
    const std::size_t others = repeats + 1 - longest.messages;
    if (longest.messages <= kFewestInRow || longest.messages == all_.stamps.size() ||
        10 * others > all_.stamps.size())
      return false;
    add("D208", Gravity::kWarning,
        fmt::format("{} messages in a row, over {}, have one time stamp", longest.messages,
                    duration(Duration(longest.to - longest.from))),
        "tf and message filters take them for one message, or drop them",
        "see whether its publisher repeats its last message, or its clock stands still",
        {time_of(longest.from), time_of(longest.from)},
        longest.to == all_.times.back() ? kNever : time_of(longest.to),
        "repeated its time stamp on ");
    return true;
  }

  // In one part of the recording most stamps are those of the message before, in the rest none is.
  bool repeats_in_stretch(std::size_t repeats) {
    std::size_t first = 0, last = 0;
    for (std::size_t i = 1; i < all_.stamps.size(); ++i) {
      if (all_.stamps[i] != all_.stamps[i - 1]) continue;
      if (first == 0) first = i;
      last = i;
    }
    constexpr std::size_t kFewest = 20;
    const std::size_t stretch = last - first + 1;
    const Duration length(all_.times[last] - all_.times[first]);
    const bool is_one_row = repeats == stretch;  // which look_at_repeats() reports
    if (repeats < kFewest || is_one_row || 2 * repeats < stretch ||
        2 * stretch > all_.stamps.size() || length < 1s)
      return false;
    add("D208", Gravity::kWarning,
        fmt::format("{} of {} messages, over {}, have the time stamp of the one before", repeats,
                    stretch, duration(length)),
        "tf and message filters take them for one message, or drop them",
        "see whether its publisher repeats its last message, or its clock stands still",
        {time_of(all_.times[first]), time_of(all_.times[first])},
        last + 1 == all_.times.size() ? kNever : time_of(all_.times[last]),
        "repeated its time stamp on ");
    return true;
  }

  void report_old(Duration base) {
    add("D042", Gravity::kWarning,
        fmt::format("its stamps are {} old when they are recorded", duration(base)),
        "a node that looks for a transform, or waits for messages of one time, comes too late",
        base > 1h ? "set the clock of the device or computer that stamps them (chrony, PTP)"
                  : "see what delays them: a queue, a slow device, or a clock that is behind",
        always(), kNever, "stamped too early on ");
  }
  void report_unset_clock() {
    add("D042", Gravity::kWarning,
        "its stamps count from zero: they are of simulated time, or of a clock that was never set",
        "no transform and no other message fits to them",
        "set use_sim_time for all nodes or for none, or set the clock of the device", always(),
        kNever, "stamped with a clock that was not set on ");
  }
  void report_real_clock() {
    add("D045", Gravity::kWarning,
        "its stamps are of the real clock, those of most topics of simulated time",
        "nodes with simulated time see them as far off, and tf refuses them", kOneClock, always(),
        kNever, "stamped with the real clock on ");
  }
  void report_mixed_clocks() {
    add("D045", Gravity::kWarning,
        "its stamps are of simulated time and of the real clock by turns: it has several "
        "publishers",
        "its readers see some of its messages as far off", kOneClock, always(), kNever,
        "stamped with two clocks on ");
  }
  void report_ahead(Duration base) {
    add("D043", Gravity::kWarning,
        fmt::format("its stamps are {} ahead when they are recorded", duration(-base)),
        "tf has no transform for that time yet: a node that asks for it waits, or drops them",
        "set the clock of the device or computer that stamps them (chrony, PTP)", always(), kNever,
        "stamped too late on ");
  }

  // A lag that begins in the recording raises the upper percentiles only, and a lead lowers the lower ones.
  void look_at_stretches(Duration low, Duration high) {
    const Duration behind_limit =
        low + std::max<Duration>(200ms, 5 * (low - lag_at(all_.lags, 0.02)));
    const Duration ahead_limit =
        high - std::max<Duration>(kAhead, 5 * (lag_at(all_.lags, 0.98) - high));
    Run behind{}, ahead{};
    Duration most_behind{}, most_ahead{};
    const auto extend = [](Run& longest, Run& row, bool is_off, Nanoseconds at) {
      if (!is_off) {
        row = {};
        return;
      }
      if (row.messages++ == 0) row.from = at;
      row.to = at;
      if (row.messages > longest.messages) longest = row;
    };
    Run behind_now{}, ahead_now{};
    for (std::size_t i = 0; i < all_.lags.size(); ++i) {
      const Duration lag = all_.lags[i];
      extend(behind, behind_now, lag > behind_limit, all_.times[i]);
      extend(ahead, ahead_now, lag < ahead_limit, all_.times[i]);
      most_behind = std::max(most_behind, lag - low);
      most_ahead = std::max(most_ahead, high - lag);
    }
    report_stretch(behind, "D042", Gravity::kWarning,
                   fmt::format("its stamps fell {} further behind", duration(most_behind)),
                   "stamped too early on ");
    report_stretch(ahead, "D043", Gravity::kError,
                   fmt::format("its stamps went {} ahead", duration(most_ahead)),
                   "stamped too late on ");
  }
  void report_stretch(const Run& run, const char* code, Gravity gravity, const std::string& seen,
                      std::string words) {
    if (run.messages < kFewestInRow || Duration(run.to - run.from) < 1s) return;
    add(code, gravity,
        fmt::format("{}, for {} ({} messages)", seen, duration(Duration(run.to - run.from)),
                    run.messages),
        "transforms and other messages of the same time do not fit to them any more",
        "see what delayed them (a queue, a slow device), or whether a clock was set",
        {time_of(run.from), time_of(run.from)},
        run.to == all_.times.back() ? kNever : time_of(run.to), std::move(words));
  }

  static constexpr std::size_t kMostClockChanges = 3;  // of one publisher, whose clock is set
  static constexpr const char* kOneClock = "set use_sim_time for all nodes or for none";

  const TopicCourse& topic_;
  const Stamped& all_;
  const Examined& bag_;
  const BagCourse& course_;
  Symptoms& symptoms_;
  std::size_t clock_changes_ = 0;
  bool is_from_zero_ = false;  // the last stamp
};

}  // namespace

void look_at_stamps(const Examined& bag, Symptoms& all) {
  for (const JudgedTopic& each : bag.topics) {
    const TopicCourse& topic = *each.topic;
    if (topic.is_latched || topic.stamps.empty()) continue;
    const Stamped some = stamped(topic, bag.other_clock);
    if (some.stamps.size() < kFewestMessages) continue;
    StampLook(topic, some, bag, all).look();
  }
}

}  // namespace culprit::bag_doctor
