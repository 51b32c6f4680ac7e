// The world: plays the flight as a rosbag2 player plays the exemplar's bag.
//
// Publishes /rgb_raw (bgr8), /depth_raw (16UC1) and /gt_segmentation (8UC1) at 10 Hz of robot time,
// all three with the same stamp: frame i with i / 10 s. The flight has no end, and begins anew with
// each start of the process.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "exemplars/sunset/node_options.h"
#include "exemplars/sunset/scene.h"
#include "ros2/node.h"
#include "ros2/timer.h"

namespace culprit::sunset {

class WorldNode {
 public:
  explicit WorldNode(NodeOptions options);

  // The context outlives the node.
  Expected<void> open(ros2::Context& context);

 private:
  using Output = std::optional<ros2::Publisher<ros2::msg::Image>>;

  void play_next();

  const NodeOptions options_;
  const Scene scene_;
  std::uint64_t next_ = 0;
  std::unique_ptr<ros2::Node> node_;
  Output rgb_;
  Output depth_;
  Output truth_;
  std::optional<ros2::Timer> timer_;
};

}  // namespace culprit::sunset
