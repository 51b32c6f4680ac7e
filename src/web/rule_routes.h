// The calls about the rule file: read, check, ask the language server, change form, save.
#pragma once

#include "http/routes.h"
#include "web/rule_desk.h"

namespace culprit::web {

// `desk` must outlive the routes.
std::vector<Route> rule_routes(RuleDesk& desk);

}  // namespace culprit::web
