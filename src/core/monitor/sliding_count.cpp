#include "monitor/sliding_count.h"

#include <algorithm>

namespace culprit::monitor {

bool SlidingCount::add(Time at, std::uint32_t count) {
  advance(at);
  const bool is_same_time = !arrivals_.empty() && arrivals_.back().at == at;
  const bool overflows = arrivals_.full() && !is_same_time;
  if (overflows) {
    arrivals_.clear();
    left_ = total_;
  }
  total_ += count;
  if (is_same_time) {
    arrivals_.back().total = total_;
  } else {
    arrivals_.push_back({at, total_});
  }
  return !overflows;
}

void SlidingCount::advance(Time now) {
  while (!arrivals_.empty() && later(arrivals_.front().at, window_) <= now) {
    left_ = arrivals_.front().total;
    arrivals_.pop_front();
  }
}

Time SlidingCount::falls_below(std::uint64_t wanted) const {
  if (wanted == 0 || count() < wanted) return kNever;
  // So many messages may leave. The first arrival that takes more of them with it is looked for: not
  // behind `high`, since each brought one message or more. It is that one if each brought one.
  const std::uint64_t most = total_ - wanted;
  std::size_t high =
      static_cast<std::size_t>(std::min<std::uint64_t>(most - left_, arrivals_.size() - 1));
  std::size_t low = high > 0 && arrivals_[high - 1].total > most ? 0 : high;
  while (low < high) {
    const std::size_t middle = low + (high - low) / 2;
    if (arrivals_[middle].total > most) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return later(arrivals_[low].at, window_);
}

}  // namespace culprit::monitor
