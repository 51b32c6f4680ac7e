// Which outcomes can have two causes.
#pragma once

#include "knowledge/knowledge.h"

namespace culprit {

// Can adapting these components (ascending) make the failure of `rule` go away? It touches one of
// them, or depends on one.
bool can_resolve(const Knowledge& knowledge, const std::vector<ComponentId>& adapted, RuleId rule);

// The strategy under way for `changed` begins to change the system. Marks every attempt whose
// outcome it can cause, and its own if another one's changes can cause that: those that touch the
// same components or are upstream of them.
void mark_ambiguous(Knowledge& knowledge, RuleId changed);

}  // namespace culprit
