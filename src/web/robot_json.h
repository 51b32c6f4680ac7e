// The manager's knowledge as JSON (docs/web.md): the constant part, the graph, the present state.
#pragma once

#include "manager/manager.h"
#include "web/event_json.h"

namespace culprit::web {

// The rule set: components, rules with their strategies, topics that are watched. The other
// documents count on the order of these lists.
Json rules_to_json(const RuleSet& rules);

// Nodes and dependencies, present or remembered (knowledge/dependency_graph.h).
Json graph_to_json(const Knowledge& knowledge);

// How it stands: rules, components, topics, inputs, beliefs. Times are seconds since `start`.
Json state_to_json(const Knowledge& knowledge, Time start);

// The counts that were learned of rules and of pairs of rules: `couplings`, `latencies`, `coincidences`, by the rules' numbers.
Json learned_to_json(const Knowledge& knowledge);

// The orders of people, and questions to them: paused or not, silences, strategies that await
// approval.
Json control_to_json(const Manager& manager, Time start);

// The open incidents, in the order of all views: part of the present state.
Json incidents_to_json(const Manager& manager, Time start);

// The state of the robot and of each component in one word (web/overview.h): part of it, too. @pre `state` is of
// this manager
void add_looks(const Manager& manager, Json& state);

}  // namespace culprit::web
