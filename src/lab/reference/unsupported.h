// Which rule sets the reference manager cannot run.
//
// Its rules read values of a blackboard, and know neither conditions of strategies nor policies
// over time.
#pragma once

#include <optional>

#include "base/expected.h"
#include "language/rule_set.h"
#include "reference/options.h"

namespace culprit::study::reference {

// Empty if it can run these rules with these options; otherwise the obstacle and the remedy.
std::optional<Error> unsupported(const RuleSet& rules, const ReferenceOptions& options);

}  // namespace culprit::study::reference
