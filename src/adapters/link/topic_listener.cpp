#include "link/topic_listener.h"

#include <utility>

namespace culprit::ros2 {

Expected<std::unique_ptr<TopicListener>> TopicListener::open(NodeEntry& self,
                                                             const std::string& topic,
                                                             const std::string& type, Keys keys,
                                                             PayloadUse use, Callbacks callbacks) {
  std::unique_ptr<TopicListener> listener(
      new TopicListener(self, topic, type, keys, use, std::move(callbacks)));
  const Qos qos{.reliability = Reliability::kBestEffort, .depth = 1, .keys = keys};
  auto now = RawSubscription::create(
      self, topic, type, qos, use,
      [raw = listener.get()](const Sample& sample) {
        raw->callbacks_.on_arrival(sample);
        raw->read(sample);
      },
      listener->callbacks_.on_unheard);
  if (!now) return Error{now.error()};
  listener->now_ = std::move(*now);
  return listener;
}

TopicListener::TopicListener(NodeEntry& self, std::string topic, std::string type, Keys keys,
                             PayloadUse use, Callbacks callbacks)
    : self_(self),
      topic_(std::move(topic)),
      type_(std::move(type)),
      keys_(keys),
      use_(use),
      callbacks_(std::move(callbacks)) {}

Expected<void> TopicListener::publisher_offers(const Qos& offered) {
  const bool latches = offered.durability == Durability::kTransientLocal &&
                       offered.reliability == Reliability::kReliable;
  if (!latches || latched_ || use_ != PayloadUse::kWhole) return {};
  const Qos qos{.durability = Durability::kTransientLocal, .depth = 1, .keys = keys_};
  auto latched = RawSubscription::create(self_, topic_, type_, qos, use_,
                                         [this](const Sample& sample) { read(sample); });
  if (!latched) return Error{latched.error()};
  latched_ = std::move(*latched);
  return {};
}

void TopicListener::read(const Sample& sample) {
  if (use_ != PayloadUse::kWhole) return;
  const MutexLock lock(mutex_);
  if (is_news(sample.identity)) callbacks_.on_message(sample);
}

// The two readers hear the same, one of them sometimes late. What is far behind is a new count.
bool TopicListener::is_news(const SampleIdentity& identity) {
  constexpr std::size_t kMaxWriters = 1000;  // the network decides how many there are
  constexpr std::int64_t kFarBehind = 1000;
  if (last_read_.size() >= kMaxWriters) last_read_.clear();
  const auto [last, is_first] = last_read_.try_emplace(identity.writer, identity.sequence);
  const std::int64_t behind = last->second - identity.sequence;
  if (!is_first && behind >= 0 && behind < kFarBehind) return false;
  last->second = identity.sequence;
  return true;
}

}  // namespace culprit::ros2
