// How often something may happen that strangers can cause and that costs something: soon again at first, and then more and more
// seldom.
#pragma once

#include <algorithm>
#include <chrono>

#include "base/time.h"

namespace culprit::ros2 {

class SeldomTimes {
 public:
  static constexpr Duration kFirstPause = std::chrono::seconds(10);
  static constexpr Duration kLongestPause = std::chrono::minutes(5);

  bool may_come(Time now) const { return now >= next_; }
  // After a time without any, as long as the longest pause, it begins anew with the first one.
  void came(Time now) {
    if (now > later(next_, kLongestPause)) pause_ = kFirstPause;
    next_ = later(now, pause_);
    pause_ = std::min(2 * pause_, kLongestPause);
  }

 private:
  Time next_ = kLongAgo;
  Duration pause_ = kFirstPause;
};

}  // namespace culprit::ros2
