#include "inbox/inbox.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

namespace culprit {
namespace {

using Steady = std::chrono::steady_clock;

Steady::time_point as_steady(Time time) {
  return Steady::time_point(std::chrono::duration_cast<Steady::duration>(time.time_since_epoch()));
}

// It comes again with the next message; the end of a process or a node does not.
bool is_sample(const Observation& o) {
  return std::holds_alternative<SampleArrived>(o.what) ||
         std::holds_alternative<SignalRead>(o.what);
}

}  // namespace

// The older half of the samples, so that a flood does not move the whole queue for each message.
void Inbox::drop_samples() {
  const auto samples = static_cast<std::size_t>(std::ranges::count_if(waiting_, is_sample));
  std::size_t left = (samples + 1) / 2;
  dropped_ += left;
  std::erase_if(waiting_, [&](const Observation& o) {
    const bool is_dropped = left > 0 && is_sample(o);
    if (is_dropped) --left;
    return is_dropped;
  });
}

void Inbox::put(Observation observation, Urgency urgency) {
  bool wake = false;
  {
    const MutexLock lock(mutex_);
    if (waiting_.size() >= kMaxWaiting && is_sample(observation)) drop_samples();
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
  if (dropped_ > 0) {
    const std::string what = std::to_string(std::exchange(dropped_, 0));
    observations.push_back(
        {live_now(), LinkTrouble{"culprit cannot keep up: it dropped " + what +
                                 " messages of the robot; is this machine overloaded?"}});
  }
}

void Inbox::interrupt() {
  {
    const MutexLock lock(mutex_);
    is_interrupted_ = true;
  }
  something_came_.notify_all();
}

}  // namespace culprit
