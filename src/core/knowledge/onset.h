// When what a rule sees began: somewhere between two times.
//
// A rule fires some time after the onset of what it watches: a silent topic must exceed a
// threshold, a reading must arrive, a monitor must compute it. Causes begin before their effects,
// whichever rule fires first (diagnose/timing.h).
#pragma once

#include "base/time.h"

namespace culprit {

struct Onset {
  Time earliest = kLongAgo;
  Time latest = kNever;  // not before `earliest`

  bool operator==(const Onset&) const = default;
};

}  // namespace culprit
