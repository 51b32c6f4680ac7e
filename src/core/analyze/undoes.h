// Does one strategy take back what another has brought about?
//
//   - Who replaces or ends a process takes what was set and called in it; culprit brings its
//     lifecycle back to where it was.
//   - Who changes a lifecycle takes back another change of it, and what was called may go with it.
//   - Who sets a parameter, an input or a mode takes back what was set there.
// That a process was replaced, or restarted, nobody takes back, but who ends it.
#pragma once

#include "language/rule_set.h"

namespace culprit {

// Carried out after `before`, does `after` take back any of it?
bool undoes(const Strategy& after, const Strategy& before);

}  // namespace culprit
