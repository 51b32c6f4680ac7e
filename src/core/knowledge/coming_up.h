// How a component came up when a process of it began: what the next start is waited for by.
#pragma once

#include <cstdint>

#include "base/time.h"

namespace culprit {

struct ComingUp {
  // Who took it through its lifecycle. kOther: itself, its launcher, a lifecycle manager.
  enum class Driver : std::uint8_t { kUnknown, kOther, kCulprit };
  Driver driver = Driver::kUnknown;
  Duration joining{};  // from the order to start it until its node was there; 0: not measured
  Duration rising{};   // from then until its lifecycle was where it should be; 0: likewise

  bool operator==(const ComingUp&) const = default;
};

}  // namespace culprit
