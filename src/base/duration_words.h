// Durations for people.
#pragma once

#include <string>

#include "base/time.h"

namespace culprit {

// A measured duration, as exact as people want it: "0 s", "12 us", "850 ms", "2.5 s", "3 min 20 s",
// "2 h 5 min", "3 days 4 h". (base/units.h: to_string() is exact, for rules.)
std::string in_words(Duration d);

}  // namespace culprit
