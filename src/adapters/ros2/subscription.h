// A node's subscriptions, of two kinds: called at once on the receive thread, or in turn on the
// executor's.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string_view>

#include "base/expected.h"
#include "base/mutex.h"
#include "ros2/context.h"
#include "ros2/executor.h"
#include "ros2/participant.h"
#include "rtps/cdr.h"

namespace culprit::ros2 {

// The shortest way from the wire to a callback: called on a receive thread, under the rules of
// participant.h.
//
// A best effort reader drops samples that it takes for old. So one forged sequence number makes it
// deaf to a writer until that writer reaches that number. A reader that receives samples and does
// not deliver them is replaced, after a delay that doubles if that does not help: samples that are
// too large, or lost in part, reach a new reader no better.
class RawSubscription {
 public:
  // `topic` as resolve_name takes it; `type` is "package/msg/Type". The node entry outlives the
  // subscription. `on_unheard` is ReaderOptions'.
  static Expected<std::unique_ptr<RawSubscription>> create(NodeEntry& node, std::string_view topic,
                                                           std::string_view type,
                                                           const rtps::Qos& qos, PayloadUse use,
                                                           SampleCallback on_sample,
                                                           std::function<void()> on_unheard = {});
  ~RawSubscription();
  RawSubscription(const RawSubscription&) = delete;
  RawSubscription& operator=(const RawSubscription&) = delete;

 private:
  static constexpr Duration kSoonest = std::chrono::seconds(1);
  static constexpr Duration kLatest = std::chrono::minutes(1);

  RawSubscription(NodeEntry& node, ReaderOptions options, SampleCallback on_sample);
  Expected<void> open();
  void close();
  void on_unheard();
  void make_anew();

  NodeEntry& node_;
  ReaderOptions options_;
  const SampleCallback on_sample_;
  const std::function<void()> tell_unheard_;

  // Used by the reader's callback.
  Time next_ = kLongAgo;
  Duration pause_ = kSoonest;

  std::unique_ptr<Reader> reader_;  // of the executor's thread, once it exists
  TaskGroup tasks_;
};

// Calls back on the executor's thread, where anything is allowed but to destroy the subscription.
// Keeps as many payloads as its QoS is deep, while that thread is busy, and no more than kMostBytes beside the newest one; then
// the oldest is dropped.
class Subscription {
 public:
  using Callback = std::function<void(rtps::ByteView payload)>;
  static constexpr std::size_t kMostBytes = std::size_t{16} << 20;

  static Expected<std::unique_ptr<Subscription>> create(NodeEntry& node, std::string_view topic,
                                                        std::string_view type, const rtps::Qos& qos,
                                                        Callback callback);
  ~Subscription();

 private:
  Subscription(Executor& executor, std::size_t depth, Callback callback);

  void on_sample(const Sample& sample);
  void deliver_next();
  rtps::Bytes take_oldest() CULPRIT_REQUIRES(mutex_);

  const std::size_t depth_;
  const Callback callback_;
  Mutex mutex_;
  std::deque<rtps::Bytes> payloads_ CULPRIT_GUARDED_BY(mutex_);
  std::size_t bytes_ CULPRIT_GUARDED_BY(mutex_) = 0;  // of them
  TaskGroup tasks_;                                   // outlives the one that posts to it
  std::unique_ptr<RawSubscription> raw_;
};

}  // namespace culprit::ros2
