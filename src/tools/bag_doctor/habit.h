// The habit of a topic: how its messages usually come, found in the recording itself, and where they came otherwise.
//
// Symbols, of the pauses between messages:
//
//   usual       their median
//   fast        the 20th percentile of the means over 20 pauses: what the topic can do
//   gap         longer than kGap usual pauses and kShortestGap, and kStandsOut times all but the three longest pauses;
//               three at most, since what pauses more often does so by habit
//   steady      nine of ten pauses are between a quarter of the usual one and four of it
//   slow        20 pauses or more in a row whose mean is longer than fast / kSlow; three such stretches at most
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/units.h"

namespace culprit::bag_doctor {

inline constexpr std::size_t kFewestMessages = 10;
inline constexpr int kGap = 5;
inline constexpr Duration kShortestGap = std::chrono::milliseconds(300);
inline constexpr double kStandsOut = 2.5;
inline constexpr double kSlow = 0.65;

struct Stretch {
  std::int64_t from = 0, to = 0;  // nanoseconds since 1970
  Duration length() const { return Duration(to - from); }
};

struct Habit {
  std::size_t messages = 0;
  Duration usual{};    // zero: fewer than kFewestMessages
  Duration fast{};     // zero: unknown
  Duration longest{};  // pause that is no gap
  bool is_steady = false;
  std::vector<Stretch> gaps{};  // from the last message before to the first one behind
  struct Slow {
    Stretch stretch;
    Duration pause{};  // its mean
  };
  std::vector<Slow> slow{};

  bool is_known() const { return usual > Duration::zero(); }
  // Time without a message after which the topic counts as silent.
  Duration patience() const;
};

// `times` ascending.
Habit habit_of(std::span<const std::int64_t> times);

}  // namespace culprit::bag_doctor
