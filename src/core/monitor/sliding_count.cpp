#include "monitor/sliding_count.h"

namespace culprit::monitor {

void SlidingCount::add(Time at, std::uint32_t count) {
  advance(at);
  count_ += count;
  const bool same_time = !arrivals_.empty() && arrivals_.back().at == at;
  if (arrivals_.full() || same_time) {
    arrivals_.back().at = at;
    arrivals_.back().count += count;
  } else {
    arrivals_.push_back({at, count});
  }
}

void SlidingCount::advance(Time now) {
  while (!arrivals_.empty() && later(arrivals_.front().at, window_) <= now) {
    count_ -= arrivals_.front().count;
    arrivals_.pop_front();
  }
}

Time SlidingCount::falls_below(std::uint64_t wanted) const {
  if (wanted == 0 || count_ < wanted) return kNever;
  // The newest arrivals that together still make `wanted`: when the oldest of them leaves, too few
  // are left.
  std::uint64_t newest = 0;
  for (std::size_t i = arrivals_.size(); i-- > 0;) {
    newest += arrivals_[i].count;
    if (newest >= wanted) return later(arrivals_[i].at, window_);
  }
  return kNever;
}

}  // namespace culprit::monitor
