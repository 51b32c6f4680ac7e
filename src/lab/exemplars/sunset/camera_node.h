// camera: takes /rgb_raw, publishes rgb_camera with the same stamp.
//
// For each frame, in this order:
// - autofocus_needed: the node is held up for kFocusingSec, says autofocus_needed = "True" on its
//   heartbeat, and the picture is defocused (F5);
// - perform_autofocus: clears both parameters and says "False"; this picture is sharp again;
// - camera_driver_issue, hardware_disconnect: the frame is dropped silently (F1);
// - image_degradation g > 0: the pixels are darkened (F4).
//
// Activating clears camera_driver_issue, configuring clears hardware_disconnect. Unlike in the
// exemplar's profile that we follow, image_degradation does not end by itself after 20 s: no
// scenario lasts that long, and the exemplar has since given it up.
#pragma once

#include <optional>

#include "exemplars/sunset/managed_node.h"

namespace culprit::sunset {

class CameraNode final : public ManagedNode {
 public:
  explicit CameraNode(NodeOptions options);

 private:
  Expected<void> activate() override;
  void deactivate() override;
  void on_frame(const ros2::msg::Image& frame);

  std::optional<ros2::Publisher<ros2::msg::Image>> publisher_;
  std::unique_ptr<ros2::Subscription> subscription_;
};

}  // namespace culprit::sunset
