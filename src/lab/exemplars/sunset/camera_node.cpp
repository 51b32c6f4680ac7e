#include "exemplars/sunset/camera_node.h"

#include "exemplars/sunset/faults.h"
#include "exemplars/sunset/nap.h"
#include "exemplars/sunset/pictures.h"

namespace culprit::sunset {

namespace msg = ros2::msg;

CameraNode::CameraNode(NodeOptions options)
    : ManagedNode({.member = Member::kCamera,
                   .parameters = {{"image_degradation", 0.0},
                                  {"camera_driver_issue", false},
                                  {"hardware_disconnect", false},
                                  {"autofocus_needed", false},
                                  {"perform_autofocus", false}},
                   .cleared_by_configure = {"hardware_disconnect"},
                   .cleared_by_activate = {"camera_driver_issue"},
                   .configure_sec = kConfigureSec},
                  std::move(options)) {}

Expected<void> CameraNode::activate() {
  auto kept = keep(publisher_, node().create_publisher<msg::Image>(topics::kRgbCamera));
  if (!kept) return kept;
  return keep(subscription_, node().create_subscription<msg::Image>(
                                 topics::kRgbRaw, rtps::qos::kDefault,
                                 [this](const msg::Image& frame) { on_frame(frame); }));
}

void CameraNode::deactivate() {
  subscription_.reset();
  publisher_.reset();
}

void CameraNode::on_frame(const msg::Image& frame) {
  if (parameter<bool>("autofocus_needed")) nap(options().wall(kFocusingSec));
  if (parameter<bool>("perform_autofocus")) {
    assign("autofocus_needed", false);
    assign("perform_autofocus", false);
  }
  // The authors' camera says it only while it is true, so that a rule cannot tell a sharp one from one that never says it.
  heartbeat().set("autofocus_needed", parameter<bool>("autofocus_needed") ? "True" : "False");
  if (parameter<bool>("camera_driver_issue") || parameter<bool>("hardware_disconnect")) return;

  auto picture = rgb_of(frame);
  if (!picture) return;
  if (parameter<bool>("autofocus_needed")) picture = defocus(*picture);
  if (const auto g = parameter<double>("image_degradation"); g > 0) picture = degrade(*picture, g);
  publisher_->publish(to_message(*picture, frame.header));
}

}  // namespace culprit::sunset
