// The rule file's requests to one component's node, beyond looking at it: only for them does
// culprit make clients that could change something.
#pragma once

#include <string>
#include <vector>

#include "language/rule_set.h"

namespace culprit::link {

struct ComponentNeeds {
  bool changes_lifecycle =
      false;                     // change_state; also of a node that is brought back after a start
  bool sets_parameters = false;  // set_parameters
  bool changes_modes = false;    // change_mode, get_mode
  // Whether it is alive is read, or it may be replaced: a running process does not prove that it
  // works.
  bool is_to_answer = false;
  std::vector<std::string> routines{};  // services that are called, as the rules name them
};

ComponentNeeds needs_of(ComponentId component, const RuleSet& rules);

}  // namespace culprit::link
