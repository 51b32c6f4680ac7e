// The robot that the explanations of `culprit check --robot` are about.
#pragma once

#include "language/live_inventory.h"

namespace culprit {

// A robot with one camera.
const LiveInventory& example_robot();

}  // namespace culprit
