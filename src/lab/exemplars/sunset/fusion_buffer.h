// The memory of sensor_fusion, and which pictures it sends together.
//
// It keeps the last few pictures of each input (6 in the paper's profile). After every arrival it
// takes, of all pairs close enough in time, the closest one that is not the pair that it took just
// before. In a bag all stamps coincide, so that "the closest" is the oldest pair, or the second
// oldest if that was taken last. Hence, as in the exemplar:
//
// - each frame is sent twice, at 20 Hz, out of order, 0.4 to 0.5 s after it was taken;
// - when one input falls silent, the other's arrivals bring out 4 or 5 more pairs: a camera outage
//   shows behind the fusion three to four frame periods late.
#pragma once

#include <cstddef>
#include <optional>

#include "exemplars/sunset/closest_pair.h"

namespace culprit::sunset {

template <class Picture>
class BasicFusionBuffer {
 public:
  static constexpr std::size_t kKeep = 6;

  explicit BasicFusionBuffer(std::size_t keep = kKeep) : keep_(keep) {}

  struct Pair {
    const Picture& rgb;  // both until the next picture is added
    const Picture& depth;
  };

  void add_rgb(Picture picture) { push(rgb_, std::move(picture), keep_); }
  void add_depth(Picture picture) { push(depth_, std::move(picture), keep_); }

  // To be called after every arrival.
  std::optional<Pair> take_pair(Duration tolerance) {
    const auto found =
        closest_pair(rgb_, depth_, tolerance, [this](const auto& rgb, const auto& depth) {
          return last_ != Stamps{stamp_of(rgb), stamp_of(depth)};
        });
    if (!found) return std::nullopt;
    const Pair pair{rgb_[found->first], depth_[found->second]};
    last_ = Stamps{stamp_of(pair.rgb), stamp_of(pair.depth)};
    return pair;
  }

  // Null if none ever came.
  const Picture* newest_rgb() const { return rgb_.empty() ? nullptr : &rgb_.back(); }
  const Picture* newest_depth() const { return depth_.empty() ? nullptr : &depth_.back(); }

 private:
  struct Stamps {
    Duration rgb;
    Duration depth;
    bool operator==(const Stamps&) const = default;
  };

  std::size_t keep_;
  Pictures<Picture> rgb_;
  Pictures<Picture> depth_;
  std::optional<Stamps> last_;
};

using FusionBuffer = BasicFusionBuffer<ros2::msg::Image>;

}  // namespace culprit::sunset
