// image_enhancement: takes rgb_camera, publishes rgb_enhanced, brightened.
//
// Its parameter image_degradation names the degradation to undo, 1.5 by default. On a healthy
// picture it does harm. It configures itself but does not activate itself, also after a
// redeployment.
#pragma once

#include <optional>

#include "exemplars/sunset/managed_node.h"

namespace culprit::sunset {

class ImageEnhancementNode final : public ManagedNode {
 public:
  explicit ImageEnhancementNode(NodeOptions options);

 private:
  Expected<void> activate() override;
  void deactivate() override;
  void on_frame(const ros2::msg::Image& frame);

  std::optional<ros2::Publisher<ros2::msg::Image>> publisher_;
  std::unique_ptr<ros2::Subscription> subscription_;
};

}  // namespace culprit::sunset
