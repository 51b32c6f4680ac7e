// The manager's events that are a decision, or the result of one, as culprit_msgs/msg/Decision.
#pragma once

#include <optional>

#include "ros_api/incident_watch.h"

namespace culprit::ros_api {

// Nothing: the event is no decision.
std::optional<Json> decision_message(const Event& event, const RuleSet& rules,
                                     const CulpritTypes& types, WallTime wall);

// A culprit_msgs/msg/Strategy that nothing was weighed of.
Json strategy_message(StrategyId strategy, const RuleSet& rules);

}  // namespace culprit::ros_api
