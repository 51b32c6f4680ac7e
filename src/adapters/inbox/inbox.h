// The queue of observations: the adapters of a live robot fill it, from any thread, and the runtime
// empties it.
#pragma once

#include <vector>

#include "base/live_clock.h"
#include "base/mutex.h"
#include "robot/observation.h"

namespace culprit {

// Whether an observation needs a reaction at once. A sample of a topic that is not silent changes
// nothing by itself. Such observations are handed over together, once all that came together are
// there, so that thousands a second do not wake a thread each.
enum class Urgency : std::uint8_t { kNow, kSoon };

// All members may be called from any thread.
class Inbox {
 public:
  // Observations that are not urgent are handed over no more often than this.
  static constexpr Duration kSoon = std::chrono::milliseconds(20);

  // If so many observations wait, the older half of the samples is dropped: a flood must not eat the
  // memory. take() then reports how many. Observations of processes, of the graph, replies and orders are
  // never dropped; the adapters limit how many a source can cause.
  static constexpr std::size_t kMaxWaiting = 1 << 16;

  // Stamps what was observed with the present time.
  template <class What>
  void put(What what, Urgency urgency = Urgency::kNow) {
    put(Observation{live_now(), std::move(what)}, urgency);
  }
  void put(Observation observation, Urgency urgency);

  // All observations that came together are there: a waiting take() gets the ones that are not urgent,
  // too. Call it again and again.
  void hand_over();

  // Waits until something urgent is there or was handed over, `until` has come, or interrupt() was called,
  // and appends what is there.
  void take(Time until, std::vector<Observation>& observations);

  // Lets the present or the next take() return at once.
  void interrupt();

 private:
  void drop_samples() CULPRIT_REQUIRES(mutex_);

  Mutex mutex_;
  ConditionVariable something_came_;
  std::vector<Observation> waiting_ CULPRIT_GUARDED_BY(mutex_);
  bool is_due_ CULPRIT_GUARDED_BY(mutex_) = false;  // something of it
  Time handed_over_ CULPRIT_GUARDED_BY(mutex_) = kLongAgo;
  std::size_t dropped_ CULPRIT_GUARDED_BY(mutex_) = 0;  // and not reported
  bool is_interrupted_ CULPRIT_GUARDED_BY(mutex_) = false;
};

}  // namespace culprit
