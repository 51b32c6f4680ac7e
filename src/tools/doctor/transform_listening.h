// Hears /tf and /tf_static: who publishes which edge of the tree, how often, and how late.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/mutex.h"
#include "doctor/picture.h"
#include "ros2/subscription.h"

namespace culprit::doctor {

// On the executor's thread, except for message callbacks.
class TransformListening {
 public:
  // The network decides how many there are, and what frames are called.
  static constexpr std::size_t kMostEdges = 10'000;
  static constexpr std::size_t kLongestName = 256;

  // `self` outlives it.
  explicit TransformListening(ros2::NodeEntry& self) : self_(self) {}

  // Called when a publisher of /tf, or /tf_static, exists.
  void listen_to(const std::string& topic, Time now);
  // Since the first of them was listened to; zero: none is.
  Duration listened(Time now) const;

  // `began`: when the look did. Without the nodes, which follow from the writers.
  struct Heard {
    rtps::Guid writer;
    Transform edge;
  };
  std::vector<Heard> heard(Time began) const;

  // Counts anew how long it listened. Its edges are kept: edges that have stopped are detected by them.
  void begin_anew(Time now);

 private:
  struct Key {
    std::string parent, child;
    rtps::Guid writer;
    bool is_static = false;
    auto operator<=>(const Key&) const = default;
  };
  struct Edge {
    std::size_t count = 0;
    Time first{}, last{};
    Duration lag{};
  };
  void on_sample(const ros2::Sample& sample, bool is_static);

  ros2::NodeEntry& self_;
  Time opened_ = kNever;
  mutable Mutex mutex_;
  std::map<Key, Edge> edges_ CULPRIT_GUARDED_BY(mutex_);
  std::map<std::string, std::unique_ptr<ros2::RawSubscription>> subscriptions_;
};

}  // namespace culprit::doctor
