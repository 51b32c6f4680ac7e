// At most so many in such a time (Erlang/OTP supervisor: intensity and period).
#pragma once

#include <deque>

#include "base/time.h"

namespace culprit {

struct Intensity {
  int most = 0;  // 0: no limit
  Duration period{};
};

// The budget of an intensity. No interval [t, t + period) ever holds more than `most`, unless more
// is spent than was available.
class IntensityBudget {
 public:
  explicit IntensityBudget(Intensity limit) : limit_(limit) {}

  // From when on one more is available; kLongAgo if it is at any time.
  Time available() const {
    const bool is_full = limit_.most > 0 && spent_.size() >= static_cast<std::size_t>(limit_.most);
    return is_full ? later(spent_.front(), limit_.period) : kLongAgo;
  }

  void spend(Time now) {
    if (limit_.most == 0) return;
    spent_.push_back(now);
    if (spent_.size() > static_cast<std::size_t>(limit_.most)) spent_.pop_front();
  }

  // Returns the last one to the budget: it was not needed.
  void give_back() {
    if (!spent_.empty()) spent_.pop_back();
  }

  const Intensity& limit() const { return limit_; }

 private:
  Intensity limit_;
  std::deque<Time> spent_;  // the last `most`, oldest first
};

}  // namespace culprit
