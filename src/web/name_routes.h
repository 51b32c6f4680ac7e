// The call that tells what the live robot has, for forms to offer.
#pragma once

#include <functional>

#include "language/live_inventory.h"
#include "web/routes.h"

namespace culprit::web {

// What the robot has by now, looking from now on at what `interest` names. Called from any thread.
using Look = std::function<Expected<LiveInventory>(const LiveInterest& interest)>;

std::vector<Route> name_routes(Look look);

}  // namespace culprit::web
