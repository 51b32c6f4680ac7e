// Is a component to be activated that a strategy has left inactive (ComponentState::is_to_be_given_back)?
//
// The next try of such a strategy gives it back. But the inactive component may have blinded its own rule, or made
// its trigger false, so that no try comes. Then it is activated as an undo is, with longer and longer pauses after
// tries in vain.
#pragma once

#include <optional>

#include "knowledge/knowledge.h"

namespace culprit::plan {

// The strategy by which it is activated now. Empty: it must not be, or need not be: a rule whose strategies do that
// anyway is not quiet.
std::optional<StrategyId> giving_back(ComponentId component, const Knowledge& knowledge);

}  // namespace culprit::plan
