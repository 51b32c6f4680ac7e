#include "exemplars/sunset/fusion_buffer.h"

namespace culprit::sunset {

std::optional<FusionBuffer::Pair> FusionBuffer::take_pair(Duration tolerance) {
  const auto found =
      closest_pair(rgb_, depth_, tolerance, [this](const auto& rgb, const auto& depth) {
        return last_ != Stamps{stamp_of(rgb), stamp_of(depth)};
      });
  if (!found) return std::nullopt;
  const Pair pair{rgb_[found->first], depth_[found->second]};
  last_ = Stamps{stamp_of(pair.rgb), stamp_of(pair.depth)};
  return pair;
}

}  // namespace culprit::sunset
