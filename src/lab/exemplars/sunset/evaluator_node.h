// evaluator: compares each segmentation with the ground truth of its frame and publishes how well
// they agree: the mean IoU, and those of vehicles and roads where the frame has any, as
// std_msgs/Float64 on /experiment_setup/{iou,vehicle_iou,road_iou}.
//
// It belongs to the experimenter: no rule reads what it says.
#pragma once

#include <memory>
#include <optional>

#include "exemplars/sunset/node_options.h"
#include "exemplars/sunset/truth_buffer.h"
#include "ros2/node.h"

namespace culprit::sunset {

class EvaluatorNode {
 public:
  explicit EvaluatorNode(const NodeOptions&) {}

  // The context outlives the node.
  Expected<void> open(ros2::Context& context);

 private:
  using Output = std::optional<ros2::Publisher<ros2::msg::Float64>>;

  Expected<std::unique_ptr<ros2::Subscription>> subscribe(
      std::string_view topic, void (TruthBuffer::*add)(ros2::msg::Image));
  void judge();

  TruthBuffer buffer_;
  std::unique_ptr<ros2::Node> node_;
  Output mean_;
  Output vehicle_;
  Output road_;
  std::unique_ptr<ros2::Subscription> truths_;
  std::unique_ptr<ros2::Subscription> predictions_;
};

}  // namespace culprit::sunset
