// What LAUNCH commands need beside themselves: their SETUP, ENV and CWD, and whether they could run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/expected.h"
#include "language/live_inventory.h"
#include "language/rule_set.h"

namespace culprit::live {

// What each component's LAUNCH has in its environment beside what it inherits, by component. Reads
// each SETUP, which takes as long as that. Errors: it cannot be read, others could change it, or it
// fails.
std::vector<Expected<std::vector<std::string>>> environments_of(const RuleSet& rules);

// Why the component's LAUNCH could not run here, as far as that can be told without running anything
// of what may be somebody else's rule file: its SETUP is only looked at, and where there is one, the
// program is not looked for. Nothing: nothing is known against it, or it has none.
std::optional<LiveInventory::LaunchTrouble> launch_trouble(const Component& component);

}  // namespace culprit::live
