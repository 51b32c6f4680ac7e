// depth: takes /depth_raw, publishes depth_camera with the same stamp.
//
// - do_drop_depth_camera: frames are dropped silently. No scenario uses it.
// - depth_degradation g > 0: noise is added to the depth.
//
// Only setting the parameter clears either.
#pragma once

#include <cstdint>
#include <optional>

#include "exemplars/sunset/managed_node.h"

namespace culprit::sunset {

class DepthNode final : public ManagedNode {
 public:
  explicit DepthNode(NodeOptions options);

 private:
  Expected<void> activate() override;
  void deactivate() override;
  void on_frame(const ros2::msg::Image& frame);

  std::uint64_t frames_ = 0;  // seeds the noise
  std::optional<ros2::Publisher<ros2::msg::Image>> publisher_;
  std::unique_ptr<ros2::Subscription> subscription_;
};

}  // namespace culprit::sunset
