#include "exemplars/sunset/sensor_fusion_node.h"

#include "exemplars/sunset/faults.h"
#include "exemplars/sunset/pictures.h"

namespace culprit::sunset {

namespace msg = ros2::msg;

namespace {

// A message that is no readable picture is passed on unchanged.
msg::Image shifted(const msg::Image& message, std::int64_t columns) {
  const auto picture = rgb_of(message);
  return picture ? to_message(shift(*picture, columns), message.header) : message;
}

}  // namespace

SensorFusionNode::SensorFusionNode(NodeOptions options)
    : ManagedNode({.member = Member::kSensorFusion,
                   .parameters = {{"topic_camera_input", std::string("rgb_camera")},
                                  {"modality", std::int64_t{FusionType::kFusion}},
                                  {"delta_t_threshold", 0.01},
                                  {"image_shift", std::int64_t{0}},
                                  {"do_recalibration", false},
                                  {"sync_issue", false},
                                  {"memory_leakage", false}},
                   .cleared_by_configure = {"memory_leakage"},
                   .cleared_by_activate = {"sync_issue"},
                   .configure_sec = kConfigureSec},
                  std::move(options)) {}

Expected<void> SensorFusionNode::activate() {
  auto kept = keep(publisher_, node().create_publisher<FusedMessage>(topics::kSensorsFused));
  if (!kept) return kept;
  kept = keep(depth_subscription_,
              node().create_subscription<msg::Image>(topics::kDepthCamera, rtps::qos::kDefault,
                                                     [this](const msg::Image& picture) {
                                                       buffer_.add_depth(picture);
                                                       on_arrival();
                                                     }));
  if (!kept) return kept;
  return take_rgb_from(parameter<std::string>("topic_camera_input"));
}

void SensorFusionNode::deactivate() {
  rgb_subscription_.reset();
  depth_subscription_.reset();
  publisher_.reset();
}

Expected<void> SensorFusionNode::on_set(const msg::Parameter& change) {
  if (change.name == "modality" && (change.value.integer_value < FusionType::kFusion ||
                                    change.value.integer_value > FusionType::kDepth)) {
    return Error{"modality must be 0 (fusion), 1 (rgb) or 2 (depth)"};
  }
  if (change.name != "topic_camera_input") return {};
  if (is_active()) return take_rgb_from(change.value.string_value);
  const auto valid = ros2::resolve_name(change.value.string_value, node().name());
  return valid ? Expected<void>() : Error{valid.error()};
}

Expected<void> SensorFusionNode::take_rgb_from(const std::string& topic) {
  return keep(rgb_subscription_, node().create_subscription<msg::Image>(
                                     topic, rtps::qos::kDefault, [this](const msg::Image& picture) {
                                       buffer_.add_rgb(picture);
                                       on_arrival();
                                     }));
}

void SensorFusionNode::on_arrival() {
  switch (parameter<std::int64_t>("modality")) {
    case FusionType::kRgb:
      return fuse(buffer_.newest_rgb(), nullptr);
    case FusionType::kDepth:
      return fuse(nullptr, buffer_.newest_depth());
    default:
      if (const auto pair =
              buffer_.take_pair(from_seconds(parameter<double>("delta_t_threshold")))) {
        fuse(&pair->rgb, &pair->depth);
      }
  }
}

void SensorFusionNode::fuse(const msg::Image* rgb, const msg::Image* depth) {
  if (rgb == nullptr && depth == nullptr) return;
  if (parameter<bool>("sync_issue") || parameter<bool>("memory_leakage")) return;
  if (parameter<bool>("do_recalibration")) {
    assign("image_shift", std::int64_t{0});
    assign("do_recalibration", false);
  }
  FusedMessage fused;
  fused.header.stamp = (rgb != nullptr ? rgb : depth)->header.stamp;
  fused.header.frame_id = topics::kSensorsFused;
  fused.modality.fusion_type = static_cast<std::uint8_t>(parameter<std::int64_t>("modality"));
  if (depth != nullptr) fused.depth = *depth;
  if (rgb != nullptr) {
    const auto columns = parameter<std::int64_t>("image_shift");
    fused.rgb = columns > 0 ? shifted(*rgb, columns) : *rgb;
  }
  publisher_->publish(fused);
}

}  // namespace culprit::sunset
