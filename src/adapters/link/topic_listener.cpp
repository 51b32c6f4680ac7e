#include "link/topic_listener.h"

#include <utility>

namespace culprit::link {

Expected<std::unique_ptr<TopicListener>> TopicListener::open(ros2::NodeEntry& self,
                                                             const std::string& topic,
                                                             const std::string& type,
                                                             rtps::Keys keys, ros2::PayloadUse use,
                                                             Callbacks callbacks) {
  std::unique_ptr<TopicListener> listener(
      new TopicListener(self, topic, type, keys, ros2::is_whole(use), std::move(callbacks)));
  auto now = listener->subscribe(use);
  if (!now) return Error{now.error()};
  listener->now_ = std::move(*now);
  return listener;
}

Expected<std::unique_ptr<ros2::RawSubscription>> TopicListener::subscribe(ros2::PayloadUse use) {
  const rtps::Qos qos{.reliability = rtps::Reliability::kBestEffort, .depth = 1, .keys = keys_};
  return ros2::RawSubscription::create(
      self_, topic_, type_, qos, use,
      [this](const ros2::Sample& sample) {
        callbacks_.on_arrival(sample);
        read(sample);
      },
      callbacks_.on_unheard);
}

TopicListener::TopicListener(ros2::NodeEntry& self, std::string topic, std::string type,
                             rtps::Keys keys, bool reads, Callbacks callbacks)
    : self_(self),
      topic_(std::move(topic)),
      type_(std::move(type)),
      keys_(keys),
      reads_(reads),
      callbacks_(std::move(callbacks)) {}

Expected<void> TopicListener::publisher_offers(const rtps::Qos& offered) {
  const bool latches = offered.durability == rtps::Durability::kTransientLocal &&
                       offered.reliability == rtps::Reliability::kReliable;
  if (!latches || latched_ || !reads_) return {};
  const rtps::Qos qos{.durability = rtps::Durability::kTransientLocal, .depth = 1, .keys = keys_};
  auto latched =
      ros2::RawSubscription::create(self_, topic_, type_, qos, ros2::PayloadUse::kWhole,
                                    [this](const ros2::Sample& sample) { read(sample); });
  if (!latched) return Error{latched.error()};
  latched_ = std::move(*latched);
  return {};
}

// Both receive until the first is removed; repeated samples are passed over.
Expected<void> TopicListener::hurry() {
  auto now = subscribe(reads_ ? ros2::PayloadUse::kWhole : ros2::PayloadUse::kBeginning);
  if (!now) return Error{now.error()};
  now_ = std::move(*now);
  return {};
}

void TopicListener::read(const ros2::Sample& sample) {
  if (!reads_) return;
  const MutexLock lock(mutex_);
  if (is_news(sample.identity)) callbacks_.on_message(sample);
}

// The two readers receive the same samples, one of them sometimes late. A number that is far behind
// begins a new count.
bool TopicListener::is_news(const rtps::SampleIdentity& identity) {
  constexpr std::size_t kMaxWriters = 1000;  // the network decides how many there are
  constexpr std::int64_t kFarBehind = 1000;
  if (last_read_.size() >= kMaxWriters) last_read_.clear();
  const auto [last, is_first] = last_read_.try_emplace(identity.writer, identity.sequence);
  const std::int64_t behind = last->second - identity.sequence;
  if (!is_first && behind >= 0 && behind < kFarBehind) return false;
  last->second = identity.sequence;
  return true;
}

}  // namespace culprit::link
