#include "replay/curves.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "knowledge/plotted_values.h"
#include "plan/paper_planner.h"
#include "replay/hindsight.h"
#include "replay/replay.h"

namespace culprit::replay {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr Duration kLook = std::chrono::seconds(1);
constexpr double kHole = 5;  // s without a look: nobody knows what was in between
constexpr Duration kBefore =
    std::chrono::minutes(2);  // so that rates and windows are known at the beginning

// The looks at one run.
class Looker {
 public:
  Looker(const std::vector<std::string>& names, const RuleSet& rules, std::int64_t wall_offset,
         std::int64_t since, Curves& curves)
      : wall_offset_(wall_offset), since_(since), curves_(curves) {
    const std::vector<std::string> known = plotted_names(rules);
    for (const std::string& name : names)
      places_.push_back(static_cast<std::size_t>(std::ranges::find(known, name) - known.begin()));
  }
  // When to look again.
  Time operator()(const Manager& manager) {
    const Knowledge& knowledge = manager.knowledge();
    if (knowledge.now < next_) return next_;
    next_ = later(knowledge.now, kLook);
    const std::int64_t wall = wall_offset_ + knowledge.now.time_since_epoch().count();
    if (wall < since_) return next_;
    const std::vector<float> values = plotted_values(knowledge);
    const double clock = seconds(Duration(wall));
    if (!curves_.clocks.empty() && clock - curves_.clocks.back() > kHole)
      add(curves_.clocks.back() + 1, {});
    add(clock, values);
    return next_;
  }

 private:
  void add(double clock, const std::vector<float>& values) {
    curves_.clocks.push_back(clock);
    for (std::size_t i = 0; i < places_.size(); ++i)
      curves_.columns[i].push_back(places_[i] < values.size() ? values[places_[i]] : kUnknown);
  }

  std::int64_t wall_offset_;
  std::int64_t since_;
  Curves& curves_;
  std::vector<std::size_t> places_;  // among all values; behind them: the run has no such signal
  Time next_ = kLongAgo;
};

// The least and the greatest value of [first, last), in their order.
std::pair<float, float> extremes(const std::vector<float>& column, std::size_t first,
                                 std::size_t last) {
  std::size_t least = last;
  std::size_t greatest = last;
  for (std::size_t i = first; i < last; ++i) {
    if (std::isnan(column[i])) continue;
    if (least == last || column[i] < column[least]) least = i;
    if (greatest == last || column[i] > column[greatest]) greatest = i;
  }
  if (least == last) return {kUnknown, kUnknown};
  return {column[std::min(least, greatest)], column[std::max(least, greatest)]};
}

// Two clocks for each bucket, so that no peak is lost.
Curves thinned(const Curves& curves, std::size_t most) {
  const std::size_t count = curves.clocks.size();
  const std::size_t buckets = std::max<std::size_t>(1, most / 2);
  if (count <= most) return curves;
  Curves thin;
  thin.columns.resize(curves.columns.size());
  for (std::size_t bucket = 0; bucket < buckets; ++bucket) {
    const std::size_t first = bucket * count / buckets;
    const std::size_t last = (bucket + 1) * count / buckets;
    thin.clocks.push_back(curves.clocks[first]);
    thin.clocks.push_back(curves.clocks[(first + last) / 2]);
    for (std::size_t i = 0; i < curves.columns.size(); ++i) {
      const auto [one, other] = extremes(curves.columns[i], first, last);
      thin.columns[i].push_back(one);
      thin.columns[i].push_back(other);
    }
  }
  return thin;
}

}  // namespace

Expected<Curves> curves_of(const journal::Reader& journal, const CurveWish& wish) {
  const std::int64_t early = wish.since - kBefore.count();
  const auto runs = runs_since(journal, early);
  if (!runs) return Error{runs.error()};
  Curves curves;
  curves.columns.resize(wish.names.size());
  bool is_any = false;
  std::string why = "nothing is recorded of that time";
  for (const journal::Entry& run : *runs) {
    if (run.at > wish.until) break;
    auto recording = Recording::open(journal, run.id);
    if (!recording) {  // of an older culprit, or continued from a file that is gone
      why = recording.error();
      continue;
    }
    is_any = true;
    const Time start = recording->session().start;
    const std::int64_t offset = run.at - start.time_since_epoch().count();
    const Time from = start + Duration(std::max<std::int64_t>(0, early - run.at));
    const auto advised =
        advise(*recording, recording->rules(), std::make_unique<PaperPlanner>(), {},
               {from, nullptr, Time(Duration(wish.until - offset)),
                Looker(wish.names, recording->rules(), offset, wish.since, curves)});
    if (!advised) return Error{advised.error()};
  }
  if (!is_any) return Error{why};
  return thinned(curves, wish.most);
}

Expected<std::optional<std::int64_t>> oldest_curve(const journal::Reader& journal) {
  const auto runs = runs_since(journal, 0);
  if (!runs) return Error{runs.error()};
  return runs->empty() ? std::nullopt : std::optional(runs->front().at);
}

}  // namespace culprit::replay
