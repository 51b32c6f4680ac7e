#include "language/rule_memory.h"

#include <algorithm>
#include <functional>

namespace culprit {
namespace {

// From what was to what is.
class Renumbering {
 public:
  Renumbering(const Symbols::Uses& uses, std::uint32_t moved_by)
      : uses_(uses), moved_by_(moved_by) {}

  void move(Span& span) const {
    if (span == Span{}) return;  // of a part that nobody has written
    span.begin += moved_by_;
    span.end += moved_by_;
  }
  void renew(std::vector<Diagnostic>& diagnostics) const {
    for (Diagnostic& d : diagnostics) {
      move(d.span);
      if (d.fix) move(d.fix->span);
    }
  }
  void renew(Typed& e) const {
    move(e.span);
    if (e.op == Op::kInput) e.input = uses_.now(e.input);
    for (Typed& child : e.children) renew(child);
  }
  void renew(Program& program) const {
    for (Instruction& i : program.code) {
      if (i.op == Op::kInput) i.operand = uses_.now(InputId(i.operand)).index;
    }
  }
  void renew(std::vector<ComponentId>& components) const {
    for (ComponentId& component : components) component = uses_.now(component);
  }
  void renew(Strategy& strategy) const {
    renew(strategy.when);
    renew(strategy.components);
    for (auto& a : strategy.adaptations) {
      a.component = uses_.now(a.component);
      if (syntax::names_parameter(a.type)) a.parameter = uses_.now(a.parameter);
      renew(a.value);
    }
  }

 private:
  const Symbols::Uses& uses_;
  std::uint32_t moved_by_;  // modulo 2^32, as unsigned numbers count: also backwards
};

}  // namespace

void RuleMemory::take(RuleSet& checked) {
  rules = std::move(checked.rules);
  strategies = std::move(checked.strategies);
}

std::optional<RenewedRule> renewed(RememberedRule& remembered, const syntax::Rule& written,
                                   RuleId id, StrategyId first, RuleMemory& memory) {
  RenewedRule out;
  const Renumbering renumbering(remembered.uses, written.begin - remembered.begin);
  out.rule = std::move(memory.rules[remembered.rule]);
  renumbering.renew(out.rule.components);
  const auto& components = out.rule.components;
  if (std::adjacent_find(components.begin(), components.end(), std::greater_equal<>()) !=
      components.end())
    return std::nullopt;

  out.rule.declaration = written.name;
  out.rule.inputs.clear();  // found anew, as those who read them
  renumbering.renew(out.rule.trigger);
  renumbering.renew(remembered.said);
  if (remembered.meaning) renumbering.renew(*remembered.meaning);
  const StrategyId first_was =
      out.rule.strategies.empty() ? StrategyId() : out.rule.strategies.front();
  const auto now = [&](StrategyId was) {
    return StrategyId(first.index + (was.index - first_was.index));
  };
  for (StrategyId& strategy : out.rule.strategies) {
    Strategy& renewed = out.strategies.emplace_back(std::move(memory.strategies[strategy.index]));
    renewed.rule = id;
    renumbering.renew(renewed);
    strategy = now(strategy);
  }
  remembered.begin = written.begin;
  if (!remembered.conditions) return out;

  RuleConditions& conditions =
      out.conditions.emplace(std::move(memory.conditions[*remembered.conditions]));
  conditions.written = &written;
  conditions.rule = id;
  renumbering.renew(conditions.trigger);
  for (RuleConditions::When& when : conditions.whens) {
    when.strategy = now(when.strategy);
    renumbering.renew(when.condition);
  }
  conditions.strategies.clear();
  auto strategy =
      written.strategies.begin();  // in the same order, but for those that were left out
  for (const Strategy& kept : out.strategies) {
    while (strategy->name.text != kept.name) ++strategy;
    conditions.strategies.push_back(&*strategy);
  }
  return out;
}

}  // namespace culprit
