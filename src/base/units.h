// The quantities that rules speak of, each a type of its own so that they cannot be confused.
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>
#include <string>
#include <string_view>

#include "base/expected.h"

namespace culprit {

using Duration = std::chrono::nanoseconds;

// The unit of system impact (paper, Section "Self-Adaptation Rules"): one period of the managing
// system. How long a cycle lasts is a property of the rule set (CYCLE, 200 ms unless said
// otherwise).
struct Cycles {
  std::int64_t count = 0;
  auto operator<=>(const Cycles&) const = default;
};

// 0..1. The language writes percents; `percent` converts.
struct Probability {
  double value = 0;
  auto operator<=>(const Probability&) const = default;
};

constexpr Probability percent(double p) { return {p / 100}; }

constexpr double seconds(Duration d) { return std::chrono::duration<double>(d).count(); }

// Nearest nanosecond; saturates at the ends of Duration, and NaN gives zero.
Duration from_seconds(double s);

// "500ms", "2s", "1.5min": a number and one of ns, us, ms, s, min, h, nothing in between.
Expected<Duration> parse_duration(std::string_view text);

// The shortest text that parse_duration reads as the same duration.
std::string to_string(Duration d);

}  // namespace culprit
