#include "doctor/transform_listening.h"

#include <algorithm>

#include "base/live_clock.h"
#include "ros2/navigation_messages.h"

namespace culprit::doctor {
namespace {

// "/base" was "base" in ROS 1, and some still write it.
std::string frame(const std::string& name) { return name.starts_with('/') ? name.substr(1) : name; }

}  // namespace

void TransformListening::listen_to(const std::string& topic, Time now) {
  if (subscriptions_.contains(topic)) return;
  const bool is_static = topic == "/tf_static";
  const rtps::Qos qos =
      is_static ? rtps::Qos{.durability = rtps::Durability::kTransientLocal, .depth = 100}
                : rtps::Qos{.reliability = rtps::Reliability::kBestEffort, .depth = 100};
  auto subscription = ros2::RawSubscription::create(
      self_, topic, ros2::msg::TFMessage::kType, qos, ros2::PayloadUse::kWhole,
      [this, is_static](const ros2::Sample& sample) { on_sample(sample, is_static); });
  if (!subscription) return;
  subscriptions_[topic] = std::move(*subscription);
  opened_ = std::min(opened_, now);
}

Duration TransformListening::listened(Time now) const {
  return opened_ == kNever ? Duration() : now - opened_;
}

void TransformListening::on_sample(const ros2::Sample& sample, bool is_static) {
  const auto message = rtps::decode<ros2::msg::TFMessage>(sample.payload);
  if (!message) return;
  const Time now = live_now();
  const MutexLock lock(mutex_);
  for (const ros2::msg::TransformStamped& each : message->transforms) {
    if (std::max(each.header.frame_id.size(), each.child_frame_id.size()) > kLongestName) continue;
    const Key key{frame(each.header.frame_id), frame(each.child_frame_id), sample.identity.writer,
                  is_static};
    if (edges_.size() >= kMostEdges && !edges_.contains(key)) continue;
    Edge& edge = edges_[key];
    if (edge.count++ == 0) edge.first = now;
    edge.last = now;
    edge.lag = sample.sent.time_since_epoch() - std::chrono::seconds(each.header.stamp.sec) -
               std::chrono::nanoseconds(each.header.stamp.nanosec);
  }
}

std::vector<TransformListening::Heard> TransformListening::heard(Time began) const {
  std::vector<Heard> all;
  const MutexLock lock(mutex_);
  for (const auto& [key, edge] : edges_) {
    Transform& out = all.emplace_back(Heard{key.writer, {}}).edge;
    out.parent = key.parent;
    out.child = key.child;
    out.is_static = key.is_static;
    out.count = edge.count;
    out.first = edge.first - began;
    out.last = edge.last - began;
    out.lag = edge.lag;
  }
  return all;
}

void TransformListening::begin_anew(Time now) {
  if (opened_ != kNever) opened_ = now;
}

}  // namespace culprit::doctor
