#include "base/units.h"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>

namespace culprit {
namespace {

struct Unit {
  std::string_view name;
  Duration length;
};

// Longest first: the largest unit that gives a whole number wins when a duration is written.
constexpr std::array kUnits = {
    Unit{"h", std::chrono::hours(1)},         Unit{"min", std::chrono::minutes(1)},
    Unit{"s", std::chrono::seconds(1)},       Unit{"ms", std::chrono::milliseconds(1)},
    Unit{"us", std::chrono::microseconds(1)}, Unit{"ns", Duration(1)}};

// Nearest, saturating.
Duration from_nanoseconds(double ns) {
  if (std::isnan(ns)) return Duration::zero();
  if (ns >= static_cast<double>(std::numeric_limits<Duration::rep>::max())) return Duration::max();
  if (ns <= static_cast<double>(std::numeric_limits<Duration::rep>::min())) return Duration::min();
  return Duration(static_cast<Duration::rep>(std::round(ns)));
}

}  // namespace

Duration from_seconds(double s) { return from_nanoseconds(s * 1e9); }

Expected<Duration> parse_duration(std::string_view text) {
  double number = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  const std::string_view name(rest, static_cast<std::size_t>(end - rest));
  if (error == std::errc() && std::isfinite(number)) {
    for (const Unit& unit : kUnits) {
      if (unit.name == name)
        return from_nanoseconds(number * static_cast<double>(unit.length.count()));
    }
  }
  const std::string given(text);
  if (name == "m")
    return Error{"'" + given + "' is not a duration; write " + given + "in for minutes"};
  constexpr double kMostDays = 1000;
  if (name == "d" && error == std::errc() && number >= 1 && number <= kMostDays)
    return Error{"'" + given + "' is not a duration; write " +
                 std::to_string(static_cast<int>(number * 24)) + "h"};
  return Error{"'" + given +
               "' is not a duration; write a number and a unit, as in 500ms, 2s or 1.5min"};
}

std::string to_string(Duration d) {
  if (d == Duration::zero()) return "0s";
  for (const Unit& unit : kUnits) {
    if (d % unit.length == Duration::zero())
      return std::to_string(d / unit.length) + std::string(unit.name);
  }
  return std::to_string(d.count()) + "ns";
}

}  // namespace culprit
