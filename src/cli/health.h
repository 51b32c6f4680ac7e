// The manager's knowledge as statuses for /diagnostics: one for culprit itself, one for each rule.
#pragma once

#include <vector>

#include "knowledge/knowledge.h"
#include "ros2/link.h"

namespace culprit::cli {

// OK while quiet, WARN while a failure is there and being worked on, ERROR when a rule is
// exhausted: a person must look.
std::vector<ros2::Health> health(const Knowledge& knowledge);

}  // namespace culprit::cli
