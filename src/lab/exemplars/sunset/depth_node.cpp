#include "exemplars/sunset/depth_node.h"

#include "exemplars/sunset/faults.h"
#include "exemplars/sunset/pictures.h"
#include "simulation/random.h"

namespace culprit::sunset {

namespace msg = ros2::msg;

DepthNode::DepthNode(NodeOptions options)
    : ManagedNode({.member = Member::kDepth,
                   .parameters = {{"depth_degradation", 0.0}, {"do_drop_depth_camera", false}}},
                  std::move(options)) {}

Expected<void> DepthNode::activate() {
  auto kept = keep(publisher_, node().create_publisher<msg::Image>(topics::kDepthCamera));
  if (!kept) return kept;
  return keep(subscription_, node().create_subscription<msg::Image>(
                                 topics::kDepthRaw, rtps::qos::kDefault,
                                 [this](const msg::Image& frame) { on_frame(frame); }));
}

void DepthNode::deactivate() {
  subscription_.reset();
  publisher_.reset();
}

void DepthNode::on_frame(const msg::Image& frame) {
  ++frames_;
  if (parameter<bool>("do_drop_depth_camera")) return;
  auto picture = depth_of(frame);
  if (!picture) return;
  if (const auto g = parameter<double>("depth_degradation"); g > 0) {
    picture = depth_noise(*picture, g, simulation::mix(options().seed) + frames_);
  }
  publisher_->publish(to_message(*picture, frame.header));
}

}  // namespace culprit::sunset
