#include "exemplars/sunset/segmentation_node.h"

#include <string>

#include "exemplars/sunset/pictures.h"

namespace culprit::sunset {

namespace msg = ros2::msg;

namespace {

// Two pictures of one size, or one of them; the classifier takes nothing else.
bool fit_together(const RgbImage& rgb, const DepthImage& depth) {
  if (rgb.empty() || depth.empty()) return rgb.empty() != depth.empty();
  return rgb.size == depth.size;
}

}  // namespace

SegmentationNode::SegmentationNode(NodeOptions options)
    : ManagedNode({.member = Member::kSegmentation,
                   .parameters = {{"cuda_out_of_memory", false}, {"gpu_failure", false}},
                   .cleared_by_configure = {"gpu_failure"},
                   .cleared_by_activate = {"cuda_out_of_memory"},
                   .configure_sec = kConfigureSec},
                  std::move(options)) {}

void SegmentationNode::configure() {
  if (!classifier_) classifier_ = std::make_unique<Classifier>();
}

Expected<void> SegmentationNode::activate() {
  auto kept = keep(publisher_, node().create_publisher<msg::Image>(topics::kSegmentation));
  if (!kept) return kept;
  return keep(subscription_, node().create_subscription<FusedMessage>(
                                 topics::kSensorsFused, rtps::qos::kDefault,
                                 [this](const FusedMessage& fused) { on_fused(fused); }));
}

void SegmentationNode::deactivate() {
  subscription_.reset();
  publisher_.reset();
}

void SegmentationNode::on_fused(const FusedMessage& fused) {
  if (parameter<bool>("cuda_out_of_memory") || parameter<bool>("gpu_failure")) return;
  const auto rgb = rgb_of(fused.rgb);
  const auto depth = depth_of(fused.depth);
  if (!rgb || !depth || !fit_together(*rgb, *depth)) return;
  const Image<Distribution> probabilities = classifier_->probabilities(*rgb, *depth);
  heartbeat().set("entropy", std::to_string(entropy(probabilities)));
  publisher_->publish(to_message(most_likely(probabilities), fused.header));
}

}  // namespace culprit::sunset
