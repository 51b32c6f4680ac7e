// Rules for components that have none, from what the components offer (culprit run --improvise).
//
// A component that no strategy adapts is watched for failures that any component can have: its
// process or node exited or hangs, or its lifecycle fell back to unconfigured or is finalized.
//   - redeploy, if culprit knows how to launch it;
//   - restart, while its lifecycle is unconfigured: that configures and activates it again.
// Their beliefs are as weak as possible (half, confidence 2). They give up after three attempts and
// stand back behind every rule of a rule file: NON_CRITICAL.
//
// They are written in the rule language, so that everything that reads rules (the journal, replays,
// explanations, the web) has them as they were. Their names mark them: rules and
// strategies begin with "improvised_".
#pragma once

#include <string>

#include "language/rule_set.h"

namespace culprit {

inline constexpr std::string_view kImprovised = "improvised_";

// To be appended to the text of `rules`; empty if there is nothing to improvise for. Components
// that are only mentioned, without a COMPONENT line, are left alone.
std::string improvised_rules(const RuleSet& rules);

}  // namespace culprit
