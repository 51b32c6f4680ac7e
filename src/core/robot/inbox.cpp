#include "robot/inbox.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace culprit {
namespace {

using Steady = std::chrono::steady_clock;

Steady::time_point as_steady(Time time) {
  return Steady::time_point(std::chrono::duration_cast<Steady::duration>(time.time_since_epoch()));
}

}  // namespace

void Inbox::put(Observation observation, Urgency urgency) {
  bool wake = false;
  {
    const MutexLock lock(mutex_);
    if (waiting_.size() >= kMaxWaiting) {
      const auto oldest = std::find_if(waiting_.begin(), waiting_.end(), [](const Observation& o) {
        return !std::holds_alternative<Reply>(o.what);
      });
      if (oldest != waiting_.end()) waiting_.erase(oldest);
      ++dropped_;
    }
    if (urgency == Urgency::kNow) wake = !std::exchange(is_due_, true);
    waiting_.push_back(std::move(observation));
  }
  if (wake) something_came_.notify_one();
}

void Inbox::hand_over() {
  {
    const MutexLock lock(mutex_);
    if (waiting_.empty() || is_due_) return;
    const Time now = live_now();
    if (now < later(handed_over_, kSoon)) return;
    handed_over_ = now;
    is_due_ = true;
  }
  something_came_.notify_one();
}

void Inbox::take(Time until, std::vector<Observation>& observations) {
  MutexLock lock(mutex_);
  while (!is_due_ && !is_interrupted_) {
    if (until == kNever) {
      something_came_.wait(lock);
    } else if (something_came_.wait_until(lock, as_steady(until)) == std::cv_status::timeout) {
      break;
    }
  }
  is_interrupted_ = false;
  is_due_ = false;
  observations.insert(observations.end(), std::make_move_iterator(waiting_.begin()),
                      std::make_move_iterator(waiting_.end()));
  waiting_.clear();
}

void Inbox::interrupt() {
  {
    const MutexLock lock(mutex_);
    is_interrupted_ = true;
  }
  something_came_.notify_all();
}

std::size_t Inbox::dropped() const {
  const MutexLock lock(mutex_);
  return dropped_;
}

}  // namespace culprit
