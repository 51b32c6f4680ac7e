// A draft's rules and proposals about diagnostics: a rule for each level, which reports, and
// proposals for the numbers of their keys.
#pragma once

#include <string>
#include <vector>

#include "init/draft_names.h"
#include "init/part.h"
#include "init/robot_profile.h"

namespace culprit::init {

// Adds to `left_out` of what no rule was written, and why.
//
// If a status that was no error becomes one, a person is notified, and no strategy begins. Keys are
// only proposed, as comments, with the limits that they kept to: half a minute does not show all of
// a robot's healthy states.
std::vector<Part> limits(const RobotProfile& seen, Names& names,
                         std::vector<std::string>& left_out);

}  // namespace culprit::init
