#include "exemplars/sunset/evaluator_node.h"

#include <cmath>
#include <utility>

#include "exemplars/sunset/iou.h"
#include "exemplars/sunset/members.h"
#include "exemplars/sunset/pictures.h"

namespace culprit::sunset {

namespace msg = ros2::msg;

Expected<void> EvaluatorNode::open(ros2::Context& context) {
  auto node = ros2::Node::create(context, node_of(Member::kEvaluator));
  if (!node) return Error{node.error()};
  node_ = std::move(*node);
  for (auto [output, topic] :
       {std::pair(&mean_, topics::kIou), std::pair(&vehicle_, topics::kVehicleIou),
        std::pair(&road_, topics::kRoadIou)}) {
    auto publisher = node_->create_publisher<msg::Float64>(topic);
    if (!publisher) return Error{publisher.error()};
    *output = std::move(*publisher);
  }
  auto truths = subscribe(topics::kTruth, &TruthBuffer::add_truth);
  if (!truths) return Error{truths.error()};
  truths_ = std::move(*truths);
  auto predictions = subscribe(topics::kSegmentation, &TruthBuffer::add_prediction);
  if (!predictions) return Error{predictions.error()};
  predictions_ = std::move(*predictions);
  return {};
}

Expected<std::unique_ptr<ros2::Subscription>> EvaluatorNode::subscribe(
    std::string_view topic, void (TruthBuffer::*add)(msg::Image)) {
  return node_->create_subscription<msg::Image>(topic, rtps::qos::kDefault,
                                                [this, add](const msg::Image& picture) {
                                                  (buffer_.*add)(picture);
                                                  judge();
                                                });
}

void EvaluatorNode::judge() {
  const auto pair = buffer_.take_pair();
  if (!pair) return;
  const auto truth = labels_of(pair->truth);
  const auto prediction = labels_of(pair->prediction);
  if (!truth || !prediction || truth->size != prediction->size) return;
  const Iou agreement = iou(*prediction, *truth);
  for (const auto& [output, value] :
       {std::pair(&mean_, agreement.mean), std::pair(&vehicle_, agreement.vehicle()),
        std::pair(&road_, agreement.road())}) {
    if (!std::isnan(value)) (*output)->publish({value});
  }
}

}  // namespace culprit::sunset
