#include "monitor/sliding_extreme.h"

namespace culprit::monitor {

bool SlidingExtreme::add(Time at, double value) {
  const auto is_beaten = [&](double before) {
    return of_ == Of::kLeast ? before >= value : before <= value;
  };
  if (values_.full() && !is_beaten(values_.back().value)) return false;
  while (!values_.empty() && is_beaten(values_.back().value)) values_.pop_back();
  values_.push_back({at, value});
  return true;
}

void SlidingExtreme::forget_until(Time time) {
  while (!values_.empty() && values_.front().at <= time) values_.pop_front();
}

}  // namespace culprit::monitor
