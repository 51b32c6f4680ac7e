#include "journal/requests.h"

#include "json/json_writer.h"

namespace culprit::journal {
namespace {

template <class Id, class Table>
std::optional<Id> find_named(const Table& table, const std::string& name) {
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (table[i].name == name) return Id(i);
  }
  return std::nullopt;
}

}  // namespace

std::optional<RuleId> find_rule(const RuleSet& rules, const std::string& name) {
  return find_named<RuleId>(rules.rules, name);
}

std::optional<StrategyId> find_strategy(const RuleSet& rules, const std::string& rule,
                                        const std::string& strategy) {
  const auto owner = find_rule(rules, rule);
  if (!owner) return std::nullopt;
  for (const StrategyId id : rules[*owner].strategies) {
    if (rules[id].name == strategy) return id;
  }
  return std::nullopt;
}

std::optional<ComponentId> find_component(const RuleSet& rules, const std::string& name) {
  return find_named<ComponentId>(rules.components, name);
}

std::string line_of(const Command& command, const RuleSet& rules) {
  const Strategy& strategy = rules[command.purpose.strategy];
  const std::string& component = rules[command.component].name;
  constexpr std::size_t kUsual = 300;
  std::string line;
  line.reserve(kUsual);
  JsonWriter json(line);
  json.begin_object();
  json.member("command", command.id.number);
  json.member("component", component);
  json.member("request", [&] { write(command.what, json); });
  json.member("rule", rules[strategy.rule].name);
  json.member("strategy", strategy.name);
  json.member("adaptation", command.purpose.adaptation);
  json.member("undoes", command.purpose.undoes);
  json.member("before", [&] { write(command.purpose.before, json); });
  json.member("text", text_of(command, rules));
  json.end_object();
  return line;
}

std::string text_of(const Command& command, const RuleSet& rules) {
  return rules[command.component].name + ": " + culprit::to_string(command);
}

Json to_json(const Command& command, const RuleSet& rules) {
  return parse_json(line_of(command, rules));
}

Expected<Command> command_from_json(const Json& json, const RuleSet& rules) {
  const auto component = find_component(rules, text_of(json, "component"));
  const auto strategy = find_strategy(rules, text_of(json, "rule"), text_of(json, "strategy"));
  if (!component || !strategy) return Error{"an intent about what the rule file no longer has"};
  const auto request = request_from_json(json.value("request", Json()));
  if (!request) return Error{request.error()};
  Command command;
  command.id.number = static_cast<std::uint64_t>(integer_of(json, "command"));
  command.component = *component;
  command.what = *request;
  command.purpose.strategy = *strategy;
  command.purpose.adaptation = static_cast<std::uint32_t>(integer_of(json, "adaptation"));
  if (command.purpose.adaptation >= rules[*strategy].adaptations.size())
    return Error{"an intent about an adaptation that the strategy no longer has"};
  command.purpose.undoes = flag_of(json, "undoes");
  command.purpose.before = reading_from_json(json.value("before", Json()));
  return command;
}

Json to_json(const Interrupted& interrupted, const RuleSet& rules) {
  const Strategy& strategy = rules[interrupted.strategy];
  Json json = {{"rule", rules[strategy.rule].name},
               {"strategy", strategy.name},
               {"adaptations_done", interrupted.adaptations_done},
               {"has_failed", interrupted.has_failed},
               {"requests", Json::array()}};
  for (const Interrupted::Request& request : interrupted.requests) {
    Json each = to_json(request.command, rules);
    if (request.outcome) each["outcome"] = to_string(*request.outcome);
    json["requests"].push_back(std::move(each));
  }
  return json;
}

Expected<Interrupted> interrupted_from_json(const Json& json, const RuleSet& rules) {
  const auto strategy = find_strategy(rules, text_of(json, "rule"), text_of(json, "strategy"));
  if (!strategy) return Error{"a strategy that the rule file no longer has"};
  Interrupted interrupted;
  interrupted.strategy = *strategy;
  interrupted.adaptations_done = static_cast<std::size_t>(integer_of(json, "adaptations_done"));
  interrupted.has_failed = flag_of(json, "has_failed");
  const Json requests = json.value("requests", Json::array());
  if (!requests.is_array() || requests.empty() ||
      interrupted.adaptations_done > rules[*strategy].adaptations.size())
    return Error{"a damaged record of an interrupted strategy"};
  for (const Json& each : requests) {
    const auto command = command_from_json(each, rules);
    if (!command) return Error{command.error()};
    if (command->purpose.strategy != *strategy) return Error{"a request of another strategy"};
    interrupted.requests.emplace_back();
    interrupted.requests.back().command = *command;
    interrupted.requests.back().outcome = outcome_from(text_of(each, "outcome"));
  }
  return interrupted;
}

}  // namespace culprit::journal
