// The questions of other programs to a service: whether it lives, whether it is ready, its metrics.
#pragma once

#include "http/hub.h"
#include "http/routes.h"
#include "web/metrics.h"

namespace culprit::web {

// Both must outlive the routes. A decision loop that does not come round in `patience` hangs.
std::vector<Route> status_routes(Hub& hub, const Metrics& metrics,
                                 std::chrono::milliseconds patience = std::chrono::seconds(2));

}  // namespace culprit::web
