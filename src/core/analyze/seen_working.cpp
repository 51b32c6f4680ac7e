#include "analyze/seen_working.h"

#include <algorithm>

#include "base/sort_unique.h"
#include "diagnose/timing.h"

namespace culprit {
namespace {

std::vector<InputId> inputs_of(const Program& program) {
  std::vector<InputId> all;
  for (const Instruction& each : program.code) {
    if (each.op == Op::kInput) all.emplace_back(each.operand);
  }
  sort_unique(all);
  return all;
}

bool is_one_of(ComponentId component, const std::vector<ComponentId>& all) {
  return std::ranges::find(all, component) != all.end();
}

}  // namespace

SeenWorking::SeenWorking(const Knowledge& knowledge) : knowledge_(knowledge) {
  parts_.resize(knowledge.rules.rules.size());
  std::size_t most = 0;
  for (std::size_t r = 0; r < parts_.size(); ++r) {
    const Rule& rule = knowledge.rules[RuleId(r)];
    for (Program& trigger : alternatives(rule.trigger)) {
      std::vector<InputId> inputs = inputs_of(trigger);
      std::vector<InputId> guards = guards_of(rule, inputs);
      most = std::max(most, inputs.size());
      parts_[r].push_back({std::move(trigger), std::move(inputs), std::move(guards)});
    }
  }
  unknown_.reserve(2 * most);
}

// Diagnostics of others that are compared with constants, where one of the rule's own components is read, too.
std::vector<InputId> SeenWorking::guards_of(const Rule& rule,
                                            const std::vector<InputId>& inputs) const {
  const RuleSet& rules = knowledge_.rules;
  std::vector<InputId> guards;
  bool reads_own = false;
  for (const InputId id : inputs) {
    const Input& input = rules[id];
    if (input.kind != Input::Kind::kSignal) continue;
    const auto publisher = publisher_of(input.signal, rules);
    const bool is_own = publisher && is_one_of(*publisher, rule.components);
    reads_own |= is_own;
    const bool is_diagnostic = std::holds_alternative<DiagnosticKey>(rules[input.signal].source);
    const bool is_number = input.type == Type::kInt || input.type == Type::kDouble;
    const bool is_mode = !is_number || (input.only_compared && !input.thresholds.empty());
    if (!is_own && is_diagnostic && is_mode) guards.push_back(id);
  }
  if (!reads_own) guards.clear();
  return guards;
}

Time SeenWorking::until(RuleId rule, Time now) {
  Time latest = kLongAgo;
  for (const Part& part : parts_[rule.index])
    latest = std::max(latest, until(part, knowledge_.rules[rule], now));
  return latest;
}

// Until when the value of the input shows that all was well; kLongAgo: it shows nothing.
Time SeenWorking::shown_until(InputId id, Time now) const {
  const Input& input = knowledge_.rules[id];
  if (diagnose::watches_a_topic(input) && !knowledge_.signals.rhythm(input.topic).last)
    return kLongAgo;
  if (input.kind == Input::Kind::kGoals || input.kind == Input::Kind::kGoalAge)
    return std::min(knowledge_.signals.read_at(id), now);
  if (diagnose::is_over_window(input)) return now - input.window;
  if (input.kind != Input::Kind::kLifecycle) return now;
  const ComponentState& state = knowledge_.components[input.component];
  const bool is_at_work = state.lifecycle == Lifecycle::kUnknown ||
                          (state.lifecycle == Lifecycle::kActive && state.lifecycle_since < now);
  return is_at_work ? now : kLongAgo;
}

// Is the part false by what its inputs show of the time since then alone?
bool SeenWorking::is_false_since(Time since, const Part& part, Time now) {
  unknown_.clear();
  for (const InputId guard : part.guards) unknown_.push_back({guard, Slot()});
  for (const InputId input : part.inputs) {
    if (shown_until(input, now) < since) unknown_.push_back({input, Slot()});
  }
  if (unknown_.empty()) return true;  // as the whole trigger is
  const Slot trigger = evaluate(part.trigger, knowledge_.signals.slots(), unknown_);
  return trigger.known && !trigger.b;
}

Time SeenWorking::until(const Part& part, const Rule& rule, Time now) {
  Time oldest = now;
  for (const InputId id : part.inputs) {
    const Time shown = shown_until(id, now);
    const Input& input = knowledge_.rules[id];
    const bool is_idle = shown == kLongAgo && input.kind == Input::Kind::kLifecycle &&
                         is_one_of(input.component, rule.repaired);
    if (is_idle) return kLongAgo;
    if (shown != kLongAgo) oldest = std::min(oldest, shown);
  }
  if (is_false_since(now, part, now)) return now;
  return is_false_since(oldest, part, now) ? oldest : kLongAgo;
}

}  // namespace culprit
