// Rule file x robot -> warnings: names in the file that do not exist on this robot.
//
// A thing is reported once, where it is named first (a node where it is declared), without its
// consequences: the parameters of a missing node are not reported as well. All are warnings, for a
// robot changes: a node may only not be started yet.
#pragma once

#include <vector>

#include "language/checker.h"
#include "language/diagnostic.h"
#include "language/live_inventory.h"
#include "language/rule_set.h"
#include "language/syntax.h"

namespace culprit::live_checks {

// Adds to `diagnostics`, which are those of check(), and keeps them in the order of the text.
// Places that have a diagnostic already get none.
void check_live(const syntax::File& file, const RuleSet& rules, const LiveInventory& robot,
                std::vector<Diagnostic>& diagnostics);

// Only the diagnostics that check_live() would add.
std::vector<Diagnostic> missing_on(const LiveInventory& robot, const Source& source);

// The launch commands of `rules`, whose tree is `file`, that have these troubles.
std::vector<Diagnostic> cannot_launch(const syntax::File& file, const RuleSet& rules,
                                      const std::vector<LiveInventory::LaunchTrouble>& troubles);

// check(), and check_live() if there is no error.
Checked check_against(const LiveInventory& robot, const Source& source,
                      Strictness strictness = Strictness::kLenient);
Checked check_against(const LiveInventory& robot, const Expansion& rules,
                      Strictness strictness = Strictness::kLenient);

}  // namespace culprit::live_checks
