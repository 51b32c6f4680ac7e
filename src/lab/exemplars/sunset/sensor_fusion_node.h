// sensor_fusion: takes depth_camera and rgb_camera (or what topic_camera_input names), publishes
// sensors_fused with the stamp of the picture.
//
// - Which pictures go together: fusion_buffer.h; delta_t_threshold, in seconds, is how far apart
//   they may be. With modality 1 or 2 (rgb or depth alone) the newest picture goes out at every
//   arrival.
// - sync_issue, memory_leakage: nothing is published (F2).
// - image_shift n > 0: the picture is shifted, not the depth (F4).
// - do_recalibration: at the next publication clears image_shift and itself.
// - topic_camera_input changes at once, and leaves the buffers as they are.
//
// Activating clears sync_issue, configuring clears memory_leakage.
#pragma once

#include <optional>

#include "exemplars/sunset/fused_message.h"
#include "exemplars/sunset/fusion_buffer.h"
#include "exemplars/sunset/managed_node.h"

namespace culprit::sunset {

class SensorFusionNode final : public ManagedNode {
 public:
  explicit SensorFusionNode(NodeOptions options);

 private:
  Expected<void> activate() override;
  void deactivate() override;
  Expected<void> on_set(const ros2::msg::Parameter& change) override;
  Expected<void> take_rgb_from(const std::string& topic);
  void on_arrival();
  void fuse(const ros2::msg::Image* rgb, const ros2::msg::Image* depth);

  FusionBuffer buffer_;
  std::optional<ros2::Publisher<FusedMessage>> publisher_;
  std::unique_ptr<ros2::Subscription> depth_subscription_;
  std::unique_ptr<ros2::Subscription> rgb_subscription_;
};

}  // namespace culprit::sunset
