// Rules for components that nobody wrote one for, from what the components offer (culprit run
// --improvise).
//
// A component that no strategy adapts is watched for what any component can show: that its process
// or node is gone or hangs, or that its lifecycle fell back to unconfigured or is finalized.
//   - redeploy, if culprit knows how to launch it;
//   - restart, while its lifecycle is unconfigured: that configures and activates it again.
// They are believed in as little as possible (half, confidence 2), give up after three attempts and
// stand back behind every rule that somebody wrote: NON_CRITICAL.
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
