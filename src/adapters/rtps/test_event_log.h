// For tests: waits for events of other threads.
//
// A wait ends with the event that it waits for, however slow the
// machine is; the time-out is only for tests that fail.
#pragma once

#include <chrono>
#include <utility>
#include <vector>

#include "base/mutex.h"

namespace culprit::rtps {

inline constexpr std::chrono::seconds kPatience(20);

// The events in order; any thread writes them, and the test waits for them.
template <class Event>
class EventLog {
 public:
  void add(Event event) {
    // Notified under the lock: the waiting thread may destroy the log as soon as it sees the event.
    const MutexLock lock(mutex_);
    events_.push_back(std::move(event));
    added_.notify_all();
  }

  // Whether `done` became true of all events so far.
  template <class Predicate>
  bool wait(Predicate done) {
    MutexLock lock(mutex_);
    return added_.wait_for(lock, kPatience,
                           [&]() CULPRIT_REQUIRES(mutex_) { return done(events_); });
  }
  bool wait_for_count(std::size_t count) {
    return wait([count](const auto& events) { return events.size() >= count; });
  }
  template <class Predicate>
  bool wait_for_one(Predicate is_it) {
    return wait([&](const auto& events) {
      for (const auto& event : events) {
        if (is_it(event)) return true;
      }
      return false;
    });
  }

  std::vector<Event> all() const {
    const MutexLock lock(mutex_);
    return events_;
  }

 private:
  mutable Mutex mutex_;
  ConditionVariable added_;
  std::vector<Event> events_ CULPRIT_GUARDED_BY(mutex_);
};

}  // namespace culprit::rtps
