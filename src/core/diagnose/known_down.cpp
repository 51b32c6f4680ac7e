#include "diagnose/known_down.h"

#include <algorithm>

#include "diagnose/questions.h"
#include "knowledge/awaited_container.h"

namespace culprit::diagnose {

bool is_known_down(ComponentId component, const Knowledge& knowledge) {
  return knowledge.components[component].process != ProcessState::kRunning &&
         !awaited_container(component, knowledge);
}

bool replaces(const Strategy& strategy, ComponentId component) {
  return std::any_of(strategy.adaptations.begin(), strategy.adaptations.end(),
                     [&](const Adaptation& a) { return a.component == component && launches(a); });
}

bool revives(const Strategy& strategy, const Knowledge& knowledge) {
  return std::any_of(strategy.components.begin(), strategy.components.end(), [&](ComponentId c) {
    return is_known_down(c, knowledge) && replaces(strategy, c);
  });
}

bool is_known_down(RuleId rule, const Knowledge& knowledge) {
  const auto& strategies = knowledge.rules[rule].strategies;
  return std::any_of(strategies.begin(), strategies.end(),
                     [&](StrategyId s) { return revives(knowledge.rules[s], knowledge); });
}

bool is_about_hang(RuleId rule, const Knowledge& knowledge) {
  const auto begins_hung_anew = [&](const Adaptation& a) {
    return (a.type == AdaptationType::kRestart || launches(a)) &&
           (knowledge.components[a.component].hangs() || is_overdue(a.component, knowledge));
  };
  return std::ranges::any_of(knowledge.rules[rule].strategies, [&](StrategyId s) {
    return std::ranges::any_of(knowledge.rules[s].adaptations, begins_hung_anew);
  });
}

bool reads_inactive(RuleId rule, const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  const auto is_inactive = [&](ComponentId c) {
    const ComponentState& state = knowledge.components[c];
    return state.lifecycle != Lifecycle::kUnknown && state.lifecycle != Lifecycle::kActive &&
           std::ranges::binary_search(rules[rule].repaired, c);
  };
  return std::ranges::any_of(rules[rule].inputs, [&](InputId id) {
    const Input& input = rules[id];
    if (input.kind == Input::Kind::kLifecycle) return is_inactive(input.component);
    const auto* group = input.subject() == Input::Subject::kSignal
                            ? std::get_if<GroupId>(&rules[input.signal].source)
                            : nullptr;
    return group != nullptr && std::ranges::any_of(rules[*group].members, is_inactive);
  });
}

namespace {

// May a strategy of any rule bring back what answers nothing? A restart needs a process that runs.
bool is_begun_anew_by_any(ComponentId component, const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  const bool runs = knowledge.components[component].process == ProcessState::kRunning;
  const auto begins_it_anew = [&](StrategyId s) {
    return std::ranges::any_of(rules[s].adaptations, [&](const Adaptation& a) {
      return a.component == component &&
             (launches(a) || (runs && a.type == AdaptationType::kRestart));
    });
  };
  return std::ranges::any_of(knowledge.states.touching(component), [&](RuleId rule) {
    return std::ranges::any_of(rules[rule].strategies, begins_it_anew);
  });
}

}  // namespace

Time may_wait_for_answer_until(RuleId failure, ComponentId supplier, Time since,
                               const Knowledge& knowledge) {
  const RuleState& state = knowledge.states[failure];
  const bool has_end = knowledge.states.is_active(failure) && state.search.attempts == 0 &&
                       !is_begun_anew_by_any(supplier, knowledge);
  return has_end ? later(std::max(state.failing_since, since), kLongestWaitForAnswer) : kNever;
}

}  // namespace culprit::diagnose
