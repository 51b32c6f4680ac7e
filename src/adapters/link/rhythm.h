#pragma once

#include <cstddef>

#include "base/time.h"

namespace culprit::link {

// How a topic's messages arrived.
struct Rhythm {
  std::size_t messages = 0;
  Duration first_to_last{};
  Duration longest_pause{};
  bool operator==(const Rhythm&) const = default;
};

}  // namespace culprit::link
