// The calls about the live robot: the stream's data for clients that do not stay.
#pragma once

#include "http/hub.h"
#include "http/routes.h"

namespace culprit::web {

// `hub` must outlive the routes.
std::vector<Route> live_routes(Hub& hub);

}  // namespace culprit::web
