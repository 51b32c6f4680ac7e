// Numbers that differ only by rounding errors are equal.
//
// 0.2 + 7/30 and 0.3 + 4/30 are the same cost, and yet not the same double. Compared as they are,
// the rounding errors would decide between two strategies that are equally good. So numbers are
// rounded to multiples of 2^-30 before they are compared: coarser than the rounding error of any
// sum that is made here, and far finer than anything that is known of a robot. With a power of two,
// common fractions (1/2, 1/4, ...) are multiples themselves, far from the point where rounding goes
// the other way.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/invariant.h"

namespace culprit::plan {

// Beyond 2^30 all numbers are the same: windows of a day in cycles of a millisecond cost as much.
inline std::int64_t parts(double number) {
  CULPRIT_ASSERT(!std::isnan(number));
  return std::llround(std::clamp(number, -0x1p30, 0x1p30) * 0x1p30);
}

}  // namespace culprit::plan
