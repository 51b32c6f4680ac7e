// segmentation: takes sensors_fused, publishes segmentation (a class for each pixel, with the stamp
// of the input) and says on its heartbeat how unsure it was: "entropy" (classifier.h).
//
// - cuda_out_of_memory, gpu_failure: neither segmentations nor entropy are published (F3).
//
// Activating clears cuda_out_of_memory, configuring clears gpu_failure. Configuring fits the model.
#pragma once

#include <memory>
#include <optional>

#include "exemplars/sunset/classifier.h"
#include "exemplars/sunset/fused_message.h"
#include "exemplars/sunset/managed_node.h"

namespace culprit::sunset {

class SegmentationNode final : public ManagedNode {
 public:
  explicit SegmentationNode(NodeOptions options);

 private:
  void configure() override;
  Expected<void> activate() override;
  void deactivate() override;
  void on_fused(const FusedMessage& fused);

  std::unique_ptr<const Classifier> classifier_;
  std::optional<ros2::Publisher<ros2::msg::Image>> publisher_;
  std::unique_ptr<ros2::Subscription> subscription_;
};

}  // namespace culprit::sunset
