#include "monitor/value_window.h"

#include <algorithm>
#include <cmath>

#include "base/invariant.h"

namespace culprit::monitor {
namespace {

std::variant<SlidingMoments, SlidingExtreme> values_for(ValueWindow::Of of, std::size_t limit) {
  switch (of) {
    case ValueWindow::Of::kMin:
      return SlidingExtreme(SlidingExtreme::Of::kLeast, limit);
    case ValueWindow::Of::kMax:
      return SlidingExtreme(SlidingExtreme::Of::kGreatest, limit);
    case ValueWindow::Of::kStddev:
      return SlidingMoments(SlidingMoments::Of::kDeviation, limit);
    case ValueWindow::Of::kMean:
      break;
  }
  return SlidingMoments(SlidingMoments::Of::kMean, limit);
}

}  // namespace

ValueWindow::ValueWindow(Of of, Duration window, Duration longest_pause, std::size_t limit)
    : window_(window), longest_pause_(longest_pause), values_(values_for(of, limit)) {
  CULPRIT_ASSERT(window > Duration::zero() && longest_pause > Duration::zero() && limit > 0);
}

bool ValueWindow::add(Time at, double value) {
  CULPRIT_ASSERT(!std::isnan(value));
  if (since_ && later(last_, longest_pause_) < at) begin_anew();
  const auto put = [&](auto& values) {
    values.forget_until(at - window_);
    return values.add(at, value);
  };
  bool has_place = std::visit(put, values_);
  if (!has_place) {
    begin_anew();
    (void)std::visit(put, values_);
  }
  if (!since_) since_ = at;
  last_ = at;
  return has_place;
}

void ValueWindow::begin_anew() {
  since_.reset();
  std::visit([](auto& values) { values.clear(); }, values_);
}

bool ValueWindow::is_covered(Time now) const {
  return since_ && later(*since_, window_) <= now && now < later(last_, longest_pause_);
}

std::optional<double> ValueWindow::value(Time now) {
  if (!is_covered(now)) return std::nullopt;
  return std::visit(
      [&](auto& values) {
        values.forget_until(now - window_);
        return values.empty() ? std::nullopt : std::optional(values.value());
      },
      values_);
}

Time ValueWindow::next_change(Time now) const {
  if (!since_) return kNever;
  const Time ends = later(last_, longest_pause_);
  if (ends <= now) return kNever;
  const Time covered = later(*since_, window_);
  if (now < covered) return covered < ends ? covered : kNever;
  const bool is_empty = std::visit([](const auto& values) { return values.empty(); }, values_);
  if (is_empty) return kNever;
  const Time leaves = std::visit([](const auto& values) { return values.oldest(); }, values_);
  return std::min(ends, later(leaves, window_));
}

}  // namespace culprit::monitor
