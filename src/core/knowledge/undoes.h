// Does one strategy take back the effect of another?
//
//   - Replacing or ending a process undoes what was set and called in it; culprit brings its
//     lifecycle back to where it was.
//   - A change of a lifecycle undoes another change of it, and possibly what was called.
//   - Setting a parameter, an input or a mode undoes what was set there before.
//   - A restart or a replaced process is undone only by ending that process.
#pragma once

#include "language/rule_set.h"

namespace culprit {

// Carried out after `before`, does `after` take back any of it?
bool undoes(const Strategy& after, const Strategy& before);

}  // namespace culprit
