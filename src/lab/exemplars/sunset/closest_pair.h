// Which two pictures of two streams belong together: those whose stamps are closest.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>

#include "base/units.h"
#include "ros2/messages.h"

namespace culprit::sunset {

template <class Picture>
using Pictures = std::deque<Picture>;  // oldest first

// A picture is any type that has a stamp_of(picture): the live nodes' messages, the model's frames.
constexpr Duration stamp_of(const ros2::msg::Image& picture) {
  return std::chrono::seconds(picture.header.stamp.sec) +
         std::chrono::nanoseconds(picture.header.stamp.nanosec);
}

struct PairIndex {
  std::size_t first = 0;
  std::size_t second = 0;
};

// Finds the closest pair at most `tolerance` apart for which `allowed(first, second)` is true.
// Among equally close ones, the first in the order of the first stream, then of the second. Empty
// if there is none.
template <class Picture, class Allowed>
std::optional<PairIndex> closest_pair(const Pictures<Picture>& first,
                                      const Pictures<Picture>& second, Duration tolerance,
                                      Allowed allowed) {
  std::optional<PairIndex> best;
  Duration best_apart{};
  for (std::size_t i = 0; i < first.size(); ++i) {
    for (std::size_t j = 0; j < second.size(); ++j) {
      const Duration difference = stamp_of(first[i]) - stamp_of(second[j]);
      const Duration apart = difference < Duration::zero() ? -difference : difference;
      if (apart > tolerance || (best && apart >= best_apart)) continue;
      if (!allowed(first[i], second[j])) continue;
      best = {i, j};
      best_apart = apart;
    }
  }
  return best;
}

// Adds the newest picture and drops the oldest beyond `keep`.
template <class Picture>
void push(Pictures<Picture>& pictures, Picture picture, std::size_t keep) {
  pictures.push_back(std::move(picture));
  if (pictures.size() > keep) pictures.pop_front();
}

}  // namespace culprit::sunset
