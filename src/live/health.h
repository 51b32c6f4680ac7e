// The manager's knowledge as statuses for /diagnostics: one for culprit itself, one for each rule,
// one for each REQUIRED component.
#pragma once

#include <vector>

#include "knowledge/knowledge.h"
#include "link/link.h"

namespace culprit::live {

// OK while quiet, WARN while the rule is blind, or while a failure is there and being worked on, ERROR when a rule is
// exhausted: a person must look. culprit's own is WARN also while a component is not there (knowledge/presence.h). ERROR also for a REQUIRED component that is not there; each has a
// status of its own once that is known.
std::vector<ros2::Health> health(const Knowledge& knowledge);

}  // namespace culprit::live
