// How a component came up when one of its processes began: how long the next start may take, and
// what to wait for.
#pragma once

#include <algorithm>
#include <cstdint>

#include "base/time.h"

namespace culprit {

struct ComingUp {
  // The driver that took it through its lifecycle. kOther: itself, its launcher, a lifecycle
  // manager.
  enum class Driver : std::uint8_t { kUnknown, kOther, kCulprit };
  Driver driver = Driver::kUnknown;
  // From the request to start it until its node was discovered; 0: not measured. A start that was
  // given up because it took too long counts with that time: the next start is given more.
  Duration joining{};
  // Until its lifecycle was where it should be; 0 and too long as above. From the discovery of its
  // node, or from culprit's first request if that brought it up.
  Duration rising{};

  bool operator==(const ComingUp&) const = default;
};

// Beyond this, a transition of its lifecycle hangs.
inline Duration longest_transition(const ComingUp& how) {
  using namespace std::chrono_literals;
  if (how.rising <= Duration::zero()) return 10s;
  return std::clamp<Duration>(std::chrono::ceil<std::chrono::milliseconds>(4 * how.rising), 2s,
                              2min);
}

}  // namespace culprit
