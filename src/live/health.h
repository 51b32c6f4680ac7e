// The manager's knowledge as statuses for /diagnostics: one for culprit itself, one for each rule,
// one for each REQUIRED component.
#pragma once

#include <vector>

#include "knowledge/knowledge.h"
#include "link/link.h"

namespace culprit::live {

// Whether messages of the robot would arrive (Manager::hears).
enum class Reception : std::uint8_t { kWorks, kLost };

// OK while quiet, WARN while the rule is blind, or while a failure is there and being worked on, ERROR when a rule is
// exhausted: a person must look. culprit's own is WARN also while a component is not there (knowledge/presence.h). ERROR also for a REQUIRED component that is not there; each has a
// status of its own once that is known. Without reception culprit's own is ERROR, and none is OK: nothing is judged.
std::vector<link::Health> health(const Knowledge& knowledge,
                                 Reception reception = Reception::kWorks);

}  // namespace culprit::live
