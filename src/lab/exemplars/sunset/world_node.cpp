#include "exemplars/sunset/world_node.h"

#include <chrono>
#include <utility>

#include "exemplars/sunset/members.h"
#include "exemplars/sunset/pictures.h"

namespace culprit::sunset {
namespace {

namespace msg = ros2::msg;

msg::Header header_of(std::uint64_t frame) {
  const Duration stamp = from_seconds(kFramePeriodSec) * static_cast<std::int64_t>(frame);
  return {msg::to_time(std::chrono::system_clock::time_point(
              std::chrono::duration_cast<std::chrono::system_clock::duration>(stamp))),
          "drone"};
}

}  // namespace

WorldNode::WorldNode(NodeOptions options) : options_(std::move(options)), scene_(options_.seed) {}

Expected<void> WorldNode::open(ros2::Context& context) {
  auto node = ros2::Node::create(context, node_of(Member::kWorld));
  if (!node) return Error{node.error()};
  node_ = std::move(*node);
  for (auto [output, topic] :
       {std::pair(&rgb_, topics::kRgbRaw), std::pair(&depth_, topics::kDepthRaw),
        std::pair(&truth_, topics::kTruth)}) {
    auto publisher = node_->create_publisher<msg::Image>(topic);
    if (!publisher) return Error{publisher.error()};
    *output = std::move(*publisher);
  }
  timer_.emplace(context.executor(), options_.wall(kFramePeriodSec), [this] { play_next(); });
  return {};
}

void WorldNode::play_next() {
  const Frame frame = scene_.frame(next_);
  const msg::Header header = header_of(next_++);
  rgb_->publish(to_message(frame.rgb, header));
  depth_->publish(to_message(frame.depth, header));
  truth_->publish(to_message(frame.truth, header));
}

}  // namespace culprit::sunset
