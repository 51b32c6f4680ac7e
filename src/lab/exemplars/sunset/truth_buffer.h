// Which segmentation the evaluator judges by which ground truth: of the last 20 of each, the
// closest in time, at most 10 ms apart; both are used up. So the second of the two
// segmentations that the fusion causes for each frame is not judged again.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>

#include "exemplars/sunset/closest_pair.h"

namespace culprit::sunset {

template <class Picture>
class BasicTruthBuffer {
 public:
  static constexpr std::size_t kKeep = 20;
  static constexpr Duration kTolerance = std::chrono::milliseconds(10);

  void add_truth(Picture truth) { push(truths_, std::move(truth), kKeep); }
  void add_prediction(Picture prediction) { push(predictions_, std::move(prediction), kKeep); }

  struct Judgeable {
    Picture truth;
    Picture prediction;
  };
  std::optional<Judgeable> take_pair() {
    const auto found = closest_pair(truths_, predictions_, kTolerance,
                                    [](const auto&, const auto&) { return true; });
    if (!found) return std::nullopt;
    return Judgeable{take(truths_, found->first), take(predictions_, found->second)};
  }

 private:
  static Picture take(Pictures<Picture>& pictures, std::size_t index) {
    const auto place = pictures.begin() + static_cast<std::ptrdiff_t>(index);
    Picture picture = std::move(*place);
    pictures.erase(place);
    return picture;
  }

  Pictures<Picture> truths_;
  Pictures<Picture> predictions_;
};

using TruthBuffer = BasicTruthBuffer<ros2::msg::Image>;

}  // namespace culprit::sunset
