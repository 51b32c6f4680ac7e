// Requests that change the robot, and strategies that were interrupted in the middle of them, as
// JSON by name.
#pragma once

#include "journal/json.h"
#include "knowledge/interrupted.h"
#include "language/rule_set.h"

namespace culprit::journal {

// The body of an intent, and the sentence in it: "camera: set gain to 1".
std::string line_of(const Command& command, const RuleSet& rules);
std::string text_of(const Command& command, const RuleSet& rules);

// The same body, for code that adds to it.
Json to_json(const Command& command, const RuleSet& rules);

// Errors: it is no intent, or is about what `rules` does not have.
Expected<Command> command_from_json(const Json& json, const RuleSet& rules);

Json to_json(const Interrupted& interrupted, const RuleSet& rules);
Expected<Interrupted> interrupted_from_json(const Json& json, const RuleSet& rules);

// By name, as rows name them. Nothing: the rules do not have it.
std::optional<RuleId> find_rule(const RuleSet& rules, const std::string& name);
std::optional<StrategyId> find_strategy(const RuleSet& rules, const std::string& rule,
                                        const std::string& strategy);
std::optional<ComponentId> find_component(const RuleSet& rules, const std::string& name);

}  // namespace culprit::journal
