// What LAUNCH commands need beside themselves: their SETUP, ENV and CWD, and whether they could run.
#pragma once

#include <stop_token>
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

// The components whose LAUNCH could not run here, and why, as far as that can be told without running
// anything of what may be somebody else's rule file: a SETUP is only looked at, and where there is one,
// the program is not looked for. Each program is looked for once in each folder and environment, which
// takes a process. What comes after a request to stop is left out.
std::vector<LiveInventory::LaunchTrouble> launch_troubles(const RuleSet& rules,
                                                          const std::stop_token& stop = {});

}  // namespace culprit::live
