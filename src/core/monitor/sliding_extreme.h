// The least or the greatest value within a time that moves on.
//
// A value counts only as long as no later one is as extreme. So only those are kept that can still
// become the extreme: from front to back they are ever less extreme, and the front is it.
#pragma once

#include <cstdint>

#include "base/time.h"
#include "monitor/long_queue.h"

namespace culprit::monitor {

class SlidingExtreme {
 public:
  enum class Of : std::uint8_t { kLeast, kGreatest };

  // Keeps `limit` values at most; 16 bytes each.
  SlidingExtreme(Of of, std::size_t limit) : of_(of), values_(limit) {}

  // False: it cannot hold one more, and is as it was. Times never go back.
  [[nodiscard]] bool add(Time at, double value);
  // Forgets what came at `time` or before.
  void forget_until(Time time);
  void clear() { values_.clear(); }

  bool empty() const { return values_.empty(); }
  // When the value came that is the extreme now. @pre !empty()
  Time oldest() const { return values_.front().at; }
  // @pre !empty()
  double value() const { return values_.front().value; }

 private:
  struct Entry {
    Time at;
    double value = 0;
  };
  Of of_;
  LongQueue<Entry> values_;
};

}  // namespace culprit::monitor
