// How unsure the segmentation is of a picture, as a random process with the statistics of the
// exemplar's logs.
#pragma once

#include <vector>

#include "exemplars/sunset/model/frame.h"
#include "exemplars/sunset/model/profile.h"
#include "simulation/random.h"

namespace culprit::sunset::model {

// The level around which the entropy of such a picture moves.
EntropyLevel entropy_level(const Frame& frame);

class Entropy {
 public:
  // The scene changes over about this time, and the entropy with it.
  static constexpr Duration kCorrelation = std::chrono::seconds(1);

  explicit Entropy(simulation::Random random) : random_(random) {}

  // The same frame has the same entropy. A small number, not bits.
  double of(const Frame& frame);

 private:
  double scene(std::size_t number);

  simulation::Random random_;
  std::vector<double> scenes_;  // N(0, 1), by frame number
};

}  // namespace culprit::sunset::model
