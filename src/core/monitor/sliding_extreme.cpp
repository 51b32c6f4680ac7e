#include "monitor/sliding_extreme.h"

namespace culprit::monitor {

bool SlidingExtreme::add(Time at, double value) {
  const auto is_beaten = [&](std::size_t i) {
    return of_ == Of::kLeast ? values_[i].value >= value : values_[i].value <= value;
  };
  // Those that are beaten are the last ones. There may be very many.
  std::size_t low = 0;
  std::size_t high = values_.size();
  if (high > 0 && !is_beaten(high - 1)) low = high;
  while (low < high) {
    const std::size_t middle = low + (high - low) / 2;
    if (is_beaten(middle)) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  values_.truncate(low);
  if (values_.full()) return false;
  values_.push_back({at, value});
  return true;
}

void SlidingExtreme::forget_until(Time time) {
  while (!values_.empty() && values_.front().at <= time) values_.pop_front();
}

}  // namespace culprit::monitor
