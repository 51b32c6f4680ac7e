// What sensor_fusion remembers, and which pictures it sends together.
//
// It keeps the last 6 pictures of each input. After every arrival it takes, of all pairs close
// enough in time, the closest one that is not the pair that it took just before. In a bag all
// stamps coincide, so that "the closest" is the oldest pair, or the second oldest if that was taken
// last. Hence, as in the exemplar (facts 1.2, paper profile):
//
// - each frame is sent twice, at 20 Hz, out of order, 0.4 to 0.5 s after it was taken;
// - when one input falls silent, the other's arrivals bring out 4 or 5 more pairs: a camera outage
//   shows behind the fusion three to four frame periods late.
#pragma once

#include <cstddef>
#include <optional>

#include "exemplars/sunset/closest_pair.h"

namespace culprit::sunset {

class FusionBuffer {
 public:
  static constexpr std::size_t kKeep = 6;

  struct Pair {
    const ros2::msg::Image& rgb;  // both until the next picture is added
    const ros2::msg::Image& depth;
  };

  void add_rgb(ros2::msg::Image picture) { push(rgb_, std::move(picture), kKeep); }
  void add_depth(ros2::msg::Image picture) { push(depth_, std::move(picture), kKeep); }

  // To be called after every arrival.
  std::optional<Pair> take_pair(Duration tolerance);

  // Null if none ever came.
  const ros2::msg::Image* newest_rgb() const { return rgb_.empty() ? nullptr : &rgb_.back(); }
  const ros2::msg::Image* newest_depth() const { return depth_.empty() ? nullptr : &depth_.back(); }

 private:
  struct Stamps {
    Duration rgb;
    Duration depth;
    bool operator==(const Stamps&) const = default;
  };

  Pictures rgb_;
  Pictures depth_;
  std::optional<Stamps> last_;
};

}  // namespace culprit::sunset
