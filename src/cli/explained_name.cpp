#include "cli/explained_name.h"

#include <algorithm>
#include <string_view>

#include <fmt/core.h>

#include "base/closest.h"
#include "journal/session.h"
#include "json/json.h"
#include "knowledge/describe.h"
#include "language/checker.h"

namespace culprit::cli {
namespace {

std::string labelled(std::string_view label, const std::vector<std::string>& items) {
  return items.empty() ? "" : fmt::format("  {:<11} {}\n", label, listed(items));
}

ExplainedName of_rule(const RuleSet& rules, const Rule& rule) {
  std::vector<std::string> inputs;
  for (const InputId input : rule.inputs) inputs.push_back(describe(rules[input], rules));
  std::string text = fmt::format("{} is a rule: it detects a failure of level {}.\n{}", rule.name,
                                 to_string(rule.policies.criticality), labelled("reads", inputs));
  for (const StrategyId id : rule.strategies)
    text += labelled("strategy", {rules[id].name + ": " + actions_of(rules[id], rules)});
  return {"rule", {rule.name}, std::move(text)};
}

ExplainedName of_component(const RuleSet& rules, ComponentId id) {
  const Component& component = rules[id];
  std::vector<std::string> acting;
  for (const Rule& rule : rules.rules) {
    if (std::ranges::find(rule.components, id) != rule.components.end())
      acting.push_back(rule.name);
  }
  std::string text =
      fmt::format("{} is a component{}.\n{}  culprit log --component {} shows its events.\n",
                  component.name, component.node.empty() ? "" : ", the node " + component.node,
                  labelled("acted on by", acting), component.name);
  return {"component", std::move(acting), std::move(text)};
}

bool is_named(const Strategy& strategy, const Rule& rule, const std::string& name) {
  return name == strategy.name || name == rule.name + "." + strategy.name;
}

}  // namespace

std::optional<ExplainedName> find_name(const RuleSet& rules, const std::string& name) {
  for (const Rule& rule : rules.rules) {
    if (rule.name == name) return of_rule(rules, rule);
  }
  for (std::size_t c = 0; c < rules.components.size(); ++c) {
    const Component& each = rules.components[c];
    if (each.name == name || each.has_node(name)) return of_component(rules, ComponentId(c));
  }
  ExplainedName found{"strategy", {}, ""};
  for (const Strategy& strategy : rules.strategies) {
    const Rule& rule = rules[strategy.rule];
    if (!is_named(strategy, rule, name)) continue;
    found.rules.push_back(rule.name);
    found.text += fmt::format("{} is a strategy of {}: {}.\n", strategy.name, rule.name,
                              actions_of(strategy, rules));
  }
  if (found.rules.empty()) return std::nullopt;
  found.text += "  culprit beliefs show has its success rate.\n";
  return found;
}

std::string nearest_name(const RuleSet& rules, const std::string& name) {
  std::vector<std::string_view> known;
  for (const Rule& each : rules.rules) known.push_back(each.name);
  for (const Component& each : rules.components) known.push_back(each.name);
  for (const Strategy& each : rules.strategies) known.push_back(each.name);
  return closest(name, known);
}

Expected<std::optional<RuleSet>> latest_rules(const journal::Reader& journal) {
  const auto begin = journal.newest(journal::kind::kSession);
  if (!begin) return Error{begin.error()};
  if (!*begin) return std::optional<RuleSet>();
  const auto session = journal::session_from_json(parse_json((*begin)->body));
  if (!session) return std::optional<RuleSet>();
  return check(Source(session->rules_path, session->rules_text)).rules;
}

}  // namespace culprit::cli
