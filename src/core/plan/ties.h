// Numbers that differ only by rounding errors are equal.
//
// 0.2 + 7/30 and 0.3 + 4/30 are the same cost, and yet not the same double. Compared as they are,
// the rounding errors would decide between two strategies that are equally good. So what is
// compared are whole parts of 2^-30: coarse enough for any sum that is made here, far finer than
// anything that is known of a robot. Parts of a power of two, so that fractions of powers of two
// are none that a rounding error takes from one part to the next.
#pragma once

#include <cassert>
#include <cmath>
#include <cstdint>

namespace culprit::plan {

// @pre |number| < 2^30
inline std::int64_t parts(double number) {
  assert(std::abs(number) < std::ldexp(1.0, 30));
  return std::llround(std::ldexp(number, 30));
}

}  // namespace culprit::plan
