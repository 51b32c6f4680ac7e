// The call about one component, beyond the stream's data on all: its process's usage, now and before, its parameters, and its latest log lines. A page calls it
// repeatedly while it shows the component.
#pragma once

#include <functional>

#include "http/hub.h"
#include "http/routes.h"
#include "ros2/messages.h"
#include "web/name_routes.h"
#include "web/usage_history.h"

namespace culprit::web {

// The last lines that a node logged. Errors: the robot's network cannot be joined. Called from any thread.
using LogOf = std::function<Expected<std::vector<ros2::msg::Log>>(const std::string& node)>;

// `hub` and `usage` must outlive the route.
Route component_route(Hub& hub, const UsageHistory& usage, Look look, LogOf log_of);

}  // namespace culprit::web
