// Listens to one topic without disturbing it: its rhythm, and the content of its messages.
//
// One best effort reader that keeps one sample, so that it can hold no writer back; where payloads
// are not asked for they are not even copied: watching a camera costs what receiving it costs.
//
// A latched topic (transient local: a map, a robot's description) is published once, before we come.
// Only a reliable reader receives samples from before (DDS 1.4 §2.2.3.4). So a second reader is
// added once a publisher is known to be transient local.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <unordered_map>

#include "base/mutex.h"
#include "ros2/subscription.h"

namespace culprit::link {

class TopicListener {
 public:
  // On receive threads, under the rules of participant.h.
  struct Callbacks {
    // A sample came now: of the best effort reader, so each is a beat of the topic's rhythm.
    ros2::SampleCallback on_arrival;
    // A sample to read, newer than its writer's earlier ones. Needs kWhole or kWholeLater; one at a
    // time.
    ros2::SampleCallback on_message;
    // Samples came that cannot be put together (ReaderOptions).
    std::function<void()> on_unheard;
  };

  // `self` outlives the listener. `type` is "package/msg/Type". `keys`: whether its publishers have
  // them; the others are not received.
  static Expected<std::unique_ptr<TopicListener>> open(ros2::NodeEntry& self,
                                                       const std::string& topic,
                                                       const std::string& type, rtps::Keys keys,
                                                       ros2::PayloadUse use, Callbacks callbacks);
  rtps::Keys keys() const { return keys_; }

  // A publisher offers this. If it is transient local, earlier samples are read, too.
  Expected<void> publisher_offers(const rtps::Qos& offered);

  // From now on samples come at once: kWhole where kWholeLater was asked for. For a topic whose samples prove large.
  Expected<void> hurry();

 private:
  TopicListener(ros2::NodeEntry& self, std::string topic, std::string type, rtps::Keys keys,
                bool reads, Callbacks callbacks);
  Expected<std::unique_ptr<ros2::RawSubscription>> subscribe(ros2::PayloadUse use);
  void read(const ros2::Sample& sample);
  bool is_news(const rtps::SampleIdentity& identity) CULPRIT_REQUIRES(mutex_);

  ros2::NodeEntry& self_;
  const std::string topic_;
  const std::string type_;
  const rtps::Keys keys_;
  const bool reads_;  // the samples' content
  const Callbacks callbacks_;
  Mutex mutex_;
  std::unordered_map<rtps::Guid, std::int64_t> last_read_ CULPRIT_GUARDED_BY(mutex_);  // by writer
  std::unique_ptr<ros2::RawSubscription> now_;
  std::unique_ptr<ros2::RawSubscription> latched_;
};

}  // namespace culprit::link
