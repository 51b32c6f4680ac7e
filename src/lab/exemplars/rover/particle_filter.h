// Monte Carlo localization with a likelihood field (Thrun, Burgard, Fox: Probabilistic Robotics, 8.3 and 6.4), as AMCL.
#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "exemplars/rover/grid_map.h"

namespace culprit::rover {

class ParticleFilter {
 public:
  struct Estimate {
    Pose2 pose;
    double variance_x = 0;
    double variance_y = 0;
    double match = 0;  // share of the beams that end at a wall of the map, 0 to 1
  };
  // Ranges of a whole turn, from -pi on. Those of `longest` or more hit nothing.
  struct Scan {
    std::span<const float> ranges;
    double longest = 0;
  };

  ParticleFilter(const GridMap& map, std::uint64_t seed);

  // All particles near one pose.
  void place(const Pose2& near);
  // Anywhere in the map, where the scan fits best.
  void place_anywhere(const Scan& scan);
  // `motion` since the last update, in the robot's frame then.
  void update(const Pose2& motion, const Scan& scan);
  const Estimate& estimate() const { return estimate_; }

 private:
  // How far from a wall a beam ends; nothing: it hit nothing.
  std::optional<double> off(const Pose2& pose, const Scan& scan, int beam) const;
  double likelihood(const Pose2& pose, const Scan& scan, int every) const;
  void resample();
  void summarize(const Scan& scan);

  const GridMap map_;
  const std::vector<float> distances_;
  std::mt19937_64 random_;
  std::vector<Pose2> particles_;
  std::vector<double> weights_;
  Estimate estimate_;
};

}  // namespace culprit::rover
