// The names in the rules that stand for parts of the robot, and whether the robot has them as far
// as was seen.
#pragma once

#include <string>
#include <vector>

#include "knowledge/knowledge.h"

namespace culprit {

struct Named {
  Nameable what;
  // Components and topics: discovered.h. A signal of a topic's field: its topic was. Other signals,
  // parameters and diagnostics: they were read.
  bool was_seen = false;
};

// Every component, and what the triggers and conditions read, each once.
std::vector<Named> named_by_rules(const Knowledge& knowledge);

// Suggests the name that was probably meant by one that was not seen: the full name of a node that
// is there or of a topic that is published; the name, hardware id or key of a diagnostic status that
// was received; a parameter that the component has. Empty if nothing is near.
std::string nearest_name(const Nameable& name, const Knowledge& knowledge);

}  // namespace culprit
