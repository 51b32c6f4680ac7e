#include "knowledge/old_value.h"

#include <algorithm>

namespace culprit {

bool keeps_last_value(const Input& input, const RuleSet& rules) {
  const bool is_of_signal = input.subject() == Input::Subject::kSignal;
  // The health of a group follows its members.
  if (is_of_signal && std::holds_alternative<GroupId>(rules[input.signal].source)) return false;
  if (input.kind == Input::Kind::kSignal || input.kind == Input::Kind::kIsNan)
    return !rules[input.signal].stale;
  return input.kind == Input::Kind::kChanged || input.kind == Input::Kind::kLevel;
}

bool is_old(InputId id, Time heard_from, const Knowledge& knowledge) {
  if (!knowledge.signals[id].known || fresh_until(id, heard_from, knowledge) > knowledge.now)
    return false;
  const Input& input = knowledge.rules[id];
  if (input.kind == Input::Kind::kLevel) return true;
  const auto& source = knowledge.rules[input.signal].source;
  if (const auto* field = std::get_if<TopicField>(&source))
    return knowledge.graph.was_published(knowledge.rules[field->topic].name);
  const auto* parameter = std::get_if<ParameterId>(&source);
  return parameter == nullptr ||
         knowledge.components[knowledge.rules[*parameter].component].alive == false;
}

Time fresh_until(InputId id, Time heard_from, const Knowledge& knowledge) {
  const Input& input = knowledge.rules[id];
  const SignalStore::Arrivals& arrivals = knowledge.signals.arrivals(id);
  const Time last = std::max(arrivals.last, heard_from);
  if (input.kind != Input::Kind::kLevel) {
    const Signal& signal = knowledge.rules[input.signal];
    const bool is_diagnostic = std::holds_alternative<DiagnosticKey>(signal.source) ||
                               std::holds_alternative<LookedUp>(signal.source);
    if (!is_diagnostic) return later(last, kPublisherIsBack);
    if (signal.stale) return later(last, *signal.stale);
  }
  if (arrivals.count < SignalStore::kRegular) return kNever;
  return later(last, std::max<Duration>(kLeastPause, 10 * arrivals.gap));
}

std::vector<Assumed> without_old_values(const Program& condition, const Knowledge& knowledge) {
  std::vector<Assumed> without_old;
  for (const Instruction& each : condition.code) {
    if (each.op != Op::kInput) continue;
    const InputId id(each.operand);
    if (keeps_last_value(knowledge.rules[id], knowledge.rules) && is_old(id, kLongAgo, knowledge))
      without_old.push_back({id, Slot()});
  }
  return without_old;
}

Slot evaluate_now(const Program& condition, const Knowledge& knowledge) {
  return evaluate(condition, knowledge.signals.slots(), without_old_values(condition, knowledge));
}

Slot evaluate_when(const Strategy& strategy, const Knowledge& knowledge) {
  return strategy.is_last_resort ? evaluate(strategy.when, knowledge.signals.slots())
                                 : evaluate_now(strategy.when, knowledge);
}

}  // namespace culprit
