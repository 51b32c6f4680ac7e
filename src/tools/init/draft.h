// A first rule file for a robot, from what was seen of it while it was well.
#pragma once

#include <string>

#include "init/sighting.h"

namespace culprit::init {

// The text of a rule file, in the canonical layout, that `culprit check --robot --strict` finds
// nothing in: for each node whose process can be started again a component, and a rule that it is
// there and its topics go on. What was guessed is marked "# guess:", and what was left out is listed
// at the end, with the reason.
std::string draft(const Sighting& seen);

}  // namespace culprit::init
