// Numbers as a draft writes them, and what a row of measurements proves.
#pragma once

#include <cstddef>
#include <string>

#include "base/time.h"

namespace culprit::init {

// Up to the next number that people would write: 1, 1.5, 2, 3, 5 or 7.5 times a power of ten.
// @pre it is above 0
double rounded_up(double number);
Duration rounded_up(Duration time);

// "0.06", "-1.5", "1e-07": at most three digits that count, as the rule language takes it.
std::string as_number(double number);

// No measurement lies outside the range of its own sample. So with 95 % certainty at most this share of all future ones does, above (one_sided) or on both
// sides, if they are independent.
double share_above(std::size_t measurements);    // the rule of three: 3/n
double share_outside(std::size_t measurements);  // S. S. Wilks, 1941: about 4.74/n

}  // namespace culprit::init
