// The call by which people tell the manager something (robot/order.h).
#pragma once

#include <functional>

#include "language/rule_set.h"
#include "robot/order.h"
#include "web/routes.h"

namespace culprit::web {

// `rules` must outlive the routes. `submit` is called from any thread.
std::vector<Route> order_routes(const RuleSet& rules, std::function<void(Order)> submit);

}  // namespace culprit::web
