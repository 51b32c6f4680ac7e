// The names in a test file -> what they mean in the rules under test.
//
// A name that means nothing there is reported, with the nearest one that does.
#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "language/diagnostic.h"
#include "language/rule_set.h"
#include "language/syntax.h"
#include "rule_test/rule_scenario.h"

namespace culprit::rule_test {

class Names {
 public:
  Names(const RuleSet& rules, std::vector<Diagnostic>& diagnostics);

  std::optional<ComponentId> component(const syntax::Name& name);
  std::optional<RuleId> rule(const syntax::Name& name);
  // "strategy", or "Rule.strategy" where more than one rule has a strategy of that name.
  std::optional<StrategyId> strategy(const syntax::Name& name);
  std::optional<TopicId> topic(const syntax::Name& name);
  std::optional<SignalId> signal(const syntax::Name& name);
  std::optional<DiagnosticId> diagnostic(const syntax::Name& name);
  std::optional<ParameterId> parameter(ComponentId component, const syntax::Name& name);
  // A topic if it begins with '/', otherwise a signal.
  std::optional<Subject> topic_or_signal(const syntax::Name& name);

  bool is_signal(const std::string& name) const { return signals_.contains(name); }
  bool is_topic(const std::string& name) const { return topics_.contains(name); }
  bool is_rule(const std::string& name) const { return rules_by_name_.contains(name); }
  bool is_component(const std::string& name) const { return components_.contains(name); }
  bool is_strategy(const std::string& name) const { return strategies_.contains(name); }
  const std::string& label(RuleId rule) const { return rules_[rule].name; }
  const std::string& rule_of(StrategyId strategy) const {
    return rules_[rules_[strategy].rule].name;
  }
  // The rule, component or strategy that `name` was probably meant to be; empty if none is near.
  std::string closest_subject(const std::string& name) const;

 private:
  template <class I>
  using Table = std::unordered_map<std::string, I>;
  template <class I>
  std::optional<I> look_up(const Table<I>& table, const syntax::Name& name, const char* what);

  const RuleSet& rules_;
  std::vector<Diagnostic>& diagnostics_;
  Table<ComponentId> components_;
  Table<RuleId> rules_by_name_;
  Table<StrategyId> strategies_;
  Table<bool> ambiguous_;  // strategy names of more than one rule
  Table<TopicId> topics_;
  Table<SignalId> signals_;
  Table<DiagnosticId> levels_;
};

}  // namespace culprit::rule_test
