// The call that lists the live robot's names, for forms.
#pragma once

#include <functional>

#include "http/routes.h"
#include "language/live_inventory.h"
#include "language/reuse/expansion.h"

namespace culprit::web {

// The robot's names by now; from now on the names in `interest` are observed, too. Called from any
// thread.
using Look = std::function<Expected<LiveInventory>(const LiveInterest& interest)>;

// `load` finds what the rules include.
std::vector<Route> name_routes(Look look, RuleLoader load = nullptr);

// By name; null where a value is a list or not set.
Json parameters_to_json(const LiveInventory::Node& node);

}  // namespace culprit::web
