// The calls about the robot that is watched: what the stream tells, for those who do not stay.
#pragma once

#include "http/hub.h"
#include "http/routes.h"

namespace culprit::web {

// `hub` must outlive the routes.
std::vector<Route> live_routes(Hub& hub);

}  // namespace culprit::web
