#include "rule_test/names.h"

#include <algorithm>
#include <string_view>

namespace culprit::rule_test {
namespace {

template <class I>
void add_keys(const std::unordered_map<std::string, I>& table,
              std::vector<std::string_view>& keys) {
  for (const auto& [key, id] : table) keys.push_back(key);
}

// Sorted, so that among equally near names it is always the same one.
std::string nearest(const std::string& name, std::vector<std::string_view> keys) {
  std::sort(keys.begin(), keys.end());
  return closest(name, keys);
}

// The names that there are, while they fit on a line.
std::string remedy_for(const std::string& name, std::vector<std::string_view> keys) {
  constexpr std::size_t kMostListed = 8;
  std::sort(keys.begin(), keys.end());
  const std::string near = closest(name, keys);
  if (!near.empty()) return "did you mean " + near + "?";
  if (keys.empty() || keys.size() > kMostListed) return "";
  std::string list;
  for (const std::string_view key : keys) list += (list.empty() ? "" : ", ") + std::string(key);
  return "they have: " + list;
}

}  // namespace

Names::Names(const RuleSet& rules, std::vector<Diagnostic>& diagnostics)
    : rules_(rules), diagnostics_(diagnostics) {
  for (std::size_t i = 0; i < rules.components.size(); ++i)
    components_.emplace(rules.components[i].name, ComponentId(i));
  for (std::size_t i = 0; i < rules.topics.size(); ++i)
    topics_.emplace(rules.label(TopicId(i)), TopicId(i));
  for (std::size_t i = 0; i < rules.signals.size(); ++i)
    signals_.emplace(rules.signals[i].name, SignalId(i));
  for (std::size_t i = 0; i < rules.diagnostics.size(); ++i)
    levels_.emplace(rules.diagnostics[i].name, DiagnosticId(i));
  for (std::size_t i = 0; i < rules.rules.size(); ++i)
    rules_by_name_.emplace(rules.rules[i].name, RuleId(i));
  for (std::size_t i = 0; i < rules.strategies.size(); ++i) {
    const Strategy& strategy = rules.strategies[i];
    strategies_.emplace(rules[strategy.rule].name + "." + strategy.name, StrategyId(i));
    if (!strategies_.emplace(strategy.name, StrategyId(i)).second)
      ambiguous_.emplace(strategy.name, true);
  }
}

template <class I>
std::optional<I> Names::look_up(const Table<I>& table, const syntax::Name& name, const char* what) {
  if (const auto found = table.find(name.text); found != table.end()) return found->second;
  std::vector<std::string_view> keys;
  add_keys(table, keys);
  diagnostics_.push_back({Code::kUnknownName, Severity::kError, name.span,
                          "the rules have no " + std::string(what) + " '" + name.text + "'",
                          remedy_for(name.text, std::move(keys))});
  return std::nullopt;
}

std::optional<ComponentId> Names::component(const syntax::Name& name) {
  for (const Group& group : rules_.groups) {
    if (group.name != name.text || components_.contains(name.text)) continue;
    std::string members;
    for (const ComponentId member : group.members)
      members += (members.empty() ? "" : ", ") + rules_[member].name;
    diagnostics_.push_back({Code::kUnknownName, Severity::kError, name.span,
                            "'" + name.text + "' is a group, and no component",
                            "name one of its components: " + members +
                                "; what start_group answers stands behind STRATEGY"});
    return std::nullopt;
  }
  return look_up(components_, name, "component");
}
std::optional<RuleId> Names::rule(const syntax::Name& name) {
  return look_up(rules_by_name_, name, "rule");
}
std::optional<TopicId> Names::topic(const syntax::Name& name) {
  return look_up(topics_, name, "trigger that reads topic");
}
std::optional<SignalId> Names::signal(const syntax::Name& name) {
  return look_up(signals_, name, "signal");
}
std::optional<DiagnosticId> Names::diagnostic(const syntax::Name& name) {
  return look_up(levels_, name, "trigger that reads the level of");
}

std::optional<StrategyId> Names::strategy(const syntax::Name& name) {
  const std::string own = name.text.substr(name.text.rfind('.') + 1);
  const auto of_other = strategies_.find(own);
  if (!strategies_.contains(name.text) && own != name.text && of_other != strategies_.end() &&
      !ambiguous_.contains(own)) {
    const std::string& rule = rule_of(of_other->second);
    diagnostics_.push_back({Code::kUnknownName, Severity::kError, name.span,
                            "'" + own + "' is a strategy of rule " + rule,
                            "write " + rule + "." + own});
    return std::nullopt;
  }
  if (!ambiguous_.contains(name.text)) return look_up(strategies_, name, "strategy");
  const Strategy& first = rules_[strategies_.at(name.text)];
  diagnostics_.push_back({Code::kDuplicateName, Severity::kError, name.span,
                          "more than one rule has a strategy '" + name.text + "'",
                          "say which: " + rules_[first.rule].name + "." + name.text});
  return std::nullopt;
}

std::optional<ParameterId> Names::parameter(ComponentId component, const syntax::Name& name) {
  Table<ParameterId> of_component;
  for (std::size_t i = 0; i < rules_.parameters.size(); ++i) {
    if (rules_.parameters[i].component == component)
      of_component.emplace(rules_.parameters[i].name, ParameterId(i));
  }
  const std::string what = "use for this parameter of " + rules_[component].name + ":";
  return look_up(of_component, name, what.c_str());
}

std::optional<Subject> Names::topic_or_signal(const syntax::Name& name) {
  if (name.text.starts_with('/')) {
    const auto found = topic(name);
    return found ? std::optional<Subject>(*found) : std::nullopt;
  }
  if (rules_by_name_.contains(name.text) && !signals_.contains(name.text)) {
    diagnostics_.push_back({Code::kUnknownName, Severity::kError, name.span,
                            "'" + name.text + "' is a rule, not a topic or a signal",
                            "write the topics and signals that its trigger reads"});
    return std::nullopt;
  }
  if (components_.contains(name.text) && !signals_.contains(name.text)) {
    diagnostics_.push_back({Code::kUnknownName, Severity::kError, name.span,
                            "'" + name.text + "' is a component, not a topic or a signal",
                            "write the topics and signals that it publishes"});
    return std::nullopt;
  }
  const auto found = signal(name);
  return found ? std::optional<Subject>(*found) : std::nullopt;
}

std::string Names::closest_subject(const std::string& name) const {
  std::vector<std::string_view> keys;
  add_keys(rules_by_name_, keys);
  add_keys(components_, keys);
  add_keys(strategies_, keys);
  return nearest(name, std::move(keys));
}

}  // namespace culprit::rule_test
