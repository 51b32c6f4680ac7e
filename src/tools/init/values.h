// A draft's rules about values that sensors measure: frozen, not a number, or in another frame. They only report.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "init/draft_names.h"
#include "init/part.h"
#include "init/robot_profile.h"

namespace culprit::init {

// The fields of the type to be watched; empty: its messages measure nothing.
std::set<std::string> fields_of_measurement(const std::string& type);

// One part for each topic of one publisher that measures something.
//
// `frozen` is written only for values that jitter, as noise does: they change while the robot stands still, too. A value that changes
// only with the robot gets no such rule. `isnan` is written for numbers that were always finite; of elements of a list, all have to be NaN,
// since a single one may be without an echo. A frame is watched that was always the same.
std::vector<Part> values(const RobotProfile& seen, Names& names);

}  // namespace culprit::init
