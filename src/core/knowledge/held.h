// The things that last resorts hold while their failures are there (docs/governor.md).
//
//   - A parameter or a mode: it is not set to anything else. A process that begins anew has lost it, and
//     the last resort begins again; so none is kept from beginning.
//   - A lifecycle state: it is not changed, and what is to be active is not stopped. A component that was
//     deactivated is not redeployed while it lives; one that is dead is, and is then brought to inactive.
//   - A process that was stopped is not started; one that was started is not stopped.
//
// The same value or state may be set again.
#pragma once

#include <optional>

#include "knowledge/knowledge.h"

namespace culprit {

// Would `change` change what `held` brings about?
bool changes(const Adaptation& change, const Adaptation& held, const Knowledge& knowledge);

// The last resort that holds what `change` would change; empty: there is none.
std::optional<StrategyId> holder_of(const Adaptation& change, const Knowledge& knowledge);
// The same for a change by `strategy`. A last resort yields to those of other rules that are as critical as its
// own, or more. Any other strategy may replace a process that its own rule deactivated: that may repair it, and
// the new process is brought to inactive.
std::optional<StrategyId> holder_against(const Strategy& strategy, const Adaptation& change,
                                         const Knowledge& knowledge);
// There is nothing to deactivate: its process is gone, or it is in a state from which only others take it.
bool is_inactive_anyway(const ComponentState& state);

}  // namespace culprit
