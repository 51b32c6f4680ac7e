#include "robot/inbox.h"

#include <algorithm>
#include <chrono>

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
    // The first one that is not urgent wakes the reader too, who then waits a little for more.
    wake = urgency == Urgency::kNow ? !is_urgent_ : waiting_.empty();
    is_urgent_ |= urgency == Urgency::kNow;
    waiting_.push_back(std::move(observation));
  }
  if (wake) something_came_.notify_one();
}

void Inbox::take(Time until, std::vector<Observation>& observations) {
  MutexLock lock(mutex_);
  while (!is_urgent_ && !is_interrupted_) {
    const Time end = waiting_.empty() ? until : std::min(until, waiting_.front().at + kSoon);
    if (end == kNever) {
      something_came_.wait(lock);
    } else if (something_came_.wait_until(lock, as_steady(end)) == std::cv_status::timeout) {
      break;
    }
  }
  is_interrupted_ = false;
  is_urgent_ = false;
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
