// Whether culprit itself was kept from the processor a moment ago: then others may have been, and an answer that did not come
// proves nothing.
#pragma once

#include <atomic>

#include "base/time.h"

namespace culprit::link {

// Thread-safe.
class Starvation {
 public:
  // The least delay that counts. As Runtime::kLate.
  static constexpr Duration kLate = std::chrono::milliseconds(250);
  static constexpr Duration kLasts = std::chrono::seconds(10);

  // A thing that was due then is done at `now`.
  void note(Time due, Time now) {
    if (now > later(due, kLate)) until_ = later(now, kLasts);
  }
  bool is_recent(Time now) const { return now < until_.load(); }

 private:
  std::atomic<Time> until_ = kLongAgo;
};

}  // namespace culprit::link
