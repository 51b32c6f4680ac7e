// The environment of LAUNCH commands: their SETUP, ENV and CWD, and whether they could run.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "base/expected.h"
#include "language/live_inventory.h"
#include "language/rule_set.h"

namespace culprit::live {

// The variables that each component's LAUNCH gets beyond the inherited ones, by component. Runs
// each SETUP, and takes as long as they do. Errors: a SETUP cannot be read, others could change it,
// or it fails.
std::vector<Expected<std::vector<std::string>>> environments_of(const RuleSet& rules);

// The components whose LAUNCH could not run here, and why. No program of the rule file is run, since the file may be another user's: a SETUP is only inspected,
// and with a SETUP the program is not looked up. Each program is looked up once for each folder and environment, which takes a process. Checks that a stop
// request cuts off are left out.
std::vector<LiveInventory::LaunchTrouble> launch_troubles(const RuleSet& rules,
                                                          const std::stop_token& stop = {});

}  // namespace culprit::live
