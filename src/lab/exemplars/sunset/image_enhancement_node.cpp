#include "exemplars/sunset/image_enhancement_node.h"

#include "exemplars/sunset/faults.h"
#include "exemplars/sunset/pictures.h"

namespace culprit::sunset {

namespace msg = ros2::msg;

ImageEnhancementNode::ImageEnhancementNode(NodeOptions options)
    : ManagedNode({.member = Member::kImageEnhancement,
                   .parameters = {{"image_degradation", 1.5}},
                   .activates_itself = false},
                  std::move(options)) {}

Expected<void> ImageEnhancementNode::activate() {
  auto kept = keep(publisher_, node().create_publisher<msg::Image>(topics::kRgbEnhanced));
  if (!kept) return kept;
  return keep(subscription_, node().create_subscription<msg::Image>(
                                 topics::kRgbCamera, rtps::qos::kDefault,
                                 [this](const msg::Image& frame) { on_frame(frame); }));
}

void ImageEnhancementNode::deactivate() {
  subscription_.reset();
  publisher_.reset();
}

void ImageEnhancementNode::on_frame(const msg::Image& frame) {
  const auto picture = rgb_of(frame);
  if (!picture) return;
  const RgbImage enhanced = enhance(*picture, parameter<double>("image_degradation"));
  publisher_->publish(to_message(enhanced, frame.header));
}

}  // namespace culprit::sunset
