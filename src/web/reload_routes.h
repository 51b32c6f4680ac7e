// The call that lets the manager go on with the rules as the file has them now.
#pragma once

#include <functional>
#include <string>

#include "base/expected.h"
#include "http/routes.h"

namespace culprit::web {

// Begins a reload: gives how many rules the file has, or why nothing changes, with the diagnostics
// of the file. Called from any thread.
using Reload = std::function<Expected<std::size_t>(const std::string& author)>;

std::vector<Route> reload_routes(Reload reload);

}  // namespace culprit::web
