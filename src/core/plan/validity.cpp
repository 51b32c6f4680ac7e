#include "plan/validity.h"

#include <algorithm>
#include <span>

#include "base/invariant.h"
#include "diagnose/questions.h"
#include "diagnose/stays_inactive.h"
#include "diagnose/timing.h"
#include "knowledge/group_health.h"
#include "knowledge/held.h"
#include "knowledge/old_value.h"
#include "plan/also_ended.h"

namespace culprit::plan {
namespace {

bool has_lifecycle(Lifecycle state) {
  return state != Lifecycle::kUnknown && state != Lifecycle::kFinalized;
}

bool is_left_alone(const Adaptation& adaptation, const Knowledge& knowledge) {
  if (!knowledge.rivals.is_anything_left_alone()) return false;
  return adaptation.type == AdaptationType::kChangeMode &&
         knowledge.rivals.is_left_alone(adaptation.component,
                                        knowledge.began(adaptation.component));
}

bool is_of_process(AdaptationType type) {
  return type == AdaptationType::kRedeploy || type == AdaptationType::kStart ||
         type == AdaptationType::kStop;
}

// The component's node has to answer. (Modes are a mode manager's.)
bool sends_request(const Adaptation& adaptation) {
  return !is_of_process(adaptation.type) && adaptation.type != AdaptationType::kChangeMode;
}

// A member of a group that start_group has to start first.
bool starts_member(const Adaptation& adaptation, const Knowledge& knowledge) {
  return adaptation.group && adaptation.type == AdaptationType::kActivate &&
         knowledge.components[adaptation.component].alive == false;
}

bool cannot_be_reached(const Adaptation& adaptation, const Knowledge& knowledge) {
  return knowledge.is_unheard(adaptation.component) ||
         ((is_of_process(adaptation.type) || starts_member(adaptation, knowledge)) &&
          knowledge.components[adaptation.component].is_out_of_reach);
}

// The thing that its start needs and that is not there; empty: none is known to be missing.
std::string missing_for(const Adaptation& adaptation, const Knowledge& knowledge) {
  const bool starts = launches(adaptation) || starts_member(adaptation, knowledge);
  const std::string& missing = knowledge.components[adaptation.component].start_missing;
  return starts && !missing.empty() ? "cannot be started: " + missing : "";
}

// It was asked twice since its last answer and is silent, so it would not answer a request of the
// strategy either. The monitor calls it hung only after a longer pause than it ever had.
bool owes_answers(ComponentId component, const Knowledge& knowledge) {
  constexpr int kUnanswered = 2;
  constexpr Duration kVerdict = std::chrono::milliseconds(1900);  // as answer_to_come() waits
  const ComponentState& state = knowledge.components[component];
  const bool was_asked = (state.answers_probes && state.missed_probes >= kUnanswered) ||
                         diagnose::answers_no_question(state);
  return was_asked && later(state.answered, kVerdict) <= knowledge.now &&
         state.changes_until == kNever && !knowledge.heard_topic(component, knowledge.now);
}

bool uses_already(const Adaptation& change, const Knowledge& knowledge) {
  const auto& value = knowledge.components[change.parameter];
  return value && *value == Value(change.topic);
}

// Why `adaptation` is invalid; empty if it is not.
std::string obstacle(const Adaptation& adaptation, bool is_of_last_resort,
                     const Knowledge& knowledge) {
  const ComponentState& state = knowledge.components[adaptation.component];
  const bool is_alive = state.alive.value_or(false);
  const Component& component = knowledge.rules[adaptation.component];
  if (starts_member(adaptation, knowledge))
    return component.can_start_again() ? "" : "is not alive, and has no LAUNCH command";
  switch (adaptation.type) {
    case AdaptationType::kRedeploy:
      return component.can_start_again() ? "" : "has no LAUNCH command";
    case AdaptationType::kStart:
      if (!component.can_start()) return "has no LAUNCH command";
      return is_alive ? "is there already" : "";
    case AdaptationType::kStop:
      return is_alive || state.known_pid() != 0 ? "" : "is not there";
    case AdaptationType::kActivate:
    case AdaptationType::kDeactivate:
    case AdaptationType::kRestart:
    case AdaptationType::kSetParameter:
    case AdaptationType::kIncreaseParameter:
    case AdaptationType::kDecreaseParameter:
    case AdaptationType::kChangeCommunication:
    case AdaptationType::kChangeMode:
    case AdaptationType::kCall:
    case AdaptationType::kStartGroup:
      break;
  }
  if (!is_alive && !(is_of_last_resort && state.may_still_obey())) return "is not alive";
  if (is_left_alone(adaptation, knowledge)) return "is set back by something else";
  switch (adaptation.type) {
    case AdaptationType::kActivate:
      if (state.lifecycle == Lifecycle::kActive) return adaptation.group ? "" : "is active already";
      return has_lifecycle(state.lifecycle) ? "" : "has no known lifecycle state";
    case AdaptationType::kDeactivate:
      return state.lifecycle == Lifecycle::kActive ? "" : "is not active";
    case AdaptationType::kRestart:
      return has_lifecycle(state.lifecycle) ? "" : "has no known lifecycle state";
    case AdaptationType::kChangeCommunication:
      return uses_already(adaptation, knowledge) ? "uses " + adaptation.topic + " already" : "";
    case AdaptationType::kRedeploy:
    case AdaptationType::kStart:
    case AdaptationType::kStop:
    case AdaptationType::kSetParameter:
    case AdaptationType::kIncreaseParameter:
    case AdaptationType::kDecreaseParameter:
    case AdaptationType::kChangeMode:
    case AdaptationType::kCall:
    case AdaptationType::kStartGroup:
      break;
  }
  return "";
}

// Whether there is nothing left to do for it: an earlier try may have got so far.
bool is_met(const Adaptation& adaptation, const Knowledge& knowledge) {
  const ComponentState& state = knowledge.components[adaptation.component];
  const bool is_alive = state.alive.value_or(false);
  switch (adaptation.type) {
    case AdaptationType::kActivate:
      return is_alive && state.lifecycle == Lifecycle::kActive;
    case AdaptationType::kDeactivate:
      return state.is_at_rest();
    case AdaptationType::kStart:
      return is_alive;
    case AdaptationType::kStop:
      return state.alive == false && state.known_pid() == 0;
    case AdaptationType::kChangeCommunication:
      return uses_already(adaptation, knowledge);
    case AdaptationType::kRestart:
    case AdaptationType::kRedeploy:
    case AdaptationType::kSetParameter:
    case AdaptationType::kIncreaseParameter:
    case AdaptationType::kDecreaseParameter:
    case AdaptationType::kChangeMode:
    case AdaptationType::kCall:
    case AdaptationType::kStartGroup:
      break;
  }
  return false;
}

// Whether there is nothing left to do for it as a part of a last resort. A component that hangs may still do what
// the last resort is to end.
bool holds_already(const Adaptation& adaptation, const Knowledge& knowledge) {
  const ComponentState& state = knowledge.components[adaptation.component];
  if (adaptation.type == AdaptationType::kDeactivate)
    return is_inactive_anyway(state) ||
           (state.alive == true && state.lifecycle == Lifecycle::kInactive);
  return is_met(adaptation, knowledge);
}

// Whether the adaptation at `place` is a step with nothing to do: that is so already, or it would give back what
// no step has to take.
bool is_done_step(std::size_t place, const Strategy& strategy, const Knowledge& knowledge) {
  const Adaptation& adaptation = strategy.adaptations[place];
  if (!strategy.has_steps()) return false;
  if (is_met(adaptation, knowledge)) return true;
  const ComponentState& state = knowledge.components[adaptation.component];
  return gives_back(place, strategy) && state.is_at_rest() &&
         (state.alive == false || !state.is_to_be_given_back());
}

// Both set the same thing of one component, and not a whole process.
bool is_set_by_both(const Adaptation& a, const Adaptation& b) {
  const auto is_of_lifecycle = [](const Adaptation& each) {
    return each.type == AdaptationType::kActivate || each.type == AdaptationType::kDeactivate ||
           each.type == AdaptationType::kRestart;
  };
  if (a.component != b.component) return false;
  if (syntax::names_parameter(a.type) && syntax::names_parameter(b.type))
    return a.parameter == b.parameter;
  return (is_of_lifecycle(a) && is_of_lifecycle(b)) ||
         (a.type == AdaptationType::kChangeMode && b.type == AdaptationType::kChangeMode);
}

// The value that it would set brings back a more critical failure.
std::optional<Invalid> barred_by_another(const Strategy& strategy, const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  for (const StrategyId id : rules[strategy.rule].strategies) {
    const auto& bar = knowledge.states.bar_of(id);
    if (!bar || &rules[id] != &strategy) continue;
    for (const Adaptation& a : strategy.adaptations) {
      const bool is_pulled =
          std::ranges::any_of(rules[bar->by].adaptations,
                              [&](const Adaptation& held) { return is_set_by_both(a, held); });
      if (is_pulled && knowledge.components[a.component].node_seen <= bar->since)
        return Invalid{a.component, rules[a.component].name + " was set by " + rules[bar->by].name +
                                        ", and " + rules[rules[bar->by].rule].name +
                                        " would come back"};
    }
  }
  return std::nullopt;
}

std::string held_by(StrategyId holder, const RuleSet& rules) {
  const Strategy& last = rules[holder];
  return "is held by " + last.name + ", the last resort of " + rules[last.rule].name;
}

// A last resort holds what the strategy would change. It waits for the other failure; what its own rule holds
// is out for good.
std::optional<Invalid> held_by_last_resort(const Strategy& strategy, const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  for (const Adaptation& a : strategy.adaptations) {
    const auto holder = holder_against(strategy, a, knowledge);
    if (!holder) continue;
    const std::string why = held_by(*holder, rules);
    if (rules[*holder].rule != strategy.rule) return Invalid{a.component, why, true};
    return Invalid{a.component, rules[a.component].name + " " + why};
  }
  return std::nullopt;
}

// The nodes of one process, or of one launch, end and begin together: one of them may be held. The own rule's
// repair goes on.
std::optional<Invalid> ends_what_is_held(const Strategy& strategy, const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  const bool begins_again = std::ranges::any_of(strategy.adaptations, launches);
  Adaptation change;
  change.type = begins_again ? AdaptationType::kRedeploy : AdaptationType::kStop;
  for (const ComponentId other : also_ended(strategy, knowledge)) {
    change.component = other;
    const auto holder = holder_against(strategy, change, knowledge);
    if (holder && rules[*holder].rule != strategy.rule)
      return Invalid{other, held_by(*holder, rules), true};
  }
  return std::nullopt;
}

// It starts a group of which all members are active, and whose manager is there or cannot be started.
std::optional<Invalid> needless_start(const Strategy& strategy, const Knowledge& knowledge) {
  const auto is_needless = [&](const Adaptation& a) {
    const ComponentState& state = knowledge.components[a.component];
    return a.group && state.alive == true &&
           (a.type == AdaptationType::kRedeploy || state.lifecycle == Lifecycle::kActive);
  };
  if (!std::ranges::all_of(strategy.adaptations, is_needless)) return std::nullopt;
  const Adaptation& first = strategy.adaptations.front();
  return Invalid{first.component,
                 "all of " + knowledge.rules[*first.group].name + " are active already"};
}

// A person, or another program, deactivated what sends the rule's topics before they were missed. Beside strategies that were
// tried in vain the rule is given up.
std::optional<Invalid> stays_deactivated(const Strategy& strategy, const Knowledge& knowledge) {
  for (const Adaptation& a : strategy.adaptations) {
    if (!diagnose::stays_inactive(a.component, strategy, knowledge)) continue;
    const std::string why =
        "is inactive, and a " +
        std::string(a.type == AdaptationType::kRedeploy ? "redeploy keeps its state"
                    : a.type == AdaptationType::kCall   ? "call does not change that"
                                                        : "parameter does not change that");
    const std::vector<bool>& tried = knowledge.states[strategy.rule].search.tried;
    if (std::ranges::find(tried, true) == tried.end()) return Invalid{a.component, why, true};
    return Invalid{a.component, knowledge.rules[a.component].name + " " + why};
  }
  return std::nullopt;
}

// Does the rule act, or will it soon? One that has not begun for so long is held back: by a person, by the governor, or because
// it waits itself for the failure that asks.
bool acts_soon(RuleId rule, const Knowledge& knowledge) {
  const Duration soon = diagnose::kLongestEvidence;
  const RuleState& state = knowledge.states[rule];
  const Detection& seen = state.detection;
  switch (state.phase) {
    case RulePhase::kQuiet:
      return seen.trigger.known && seen.trigger.b && diagnose::may_fire(rule, knowledge) &&
             later(seen.trigger_since, knowledge.rules[rule].policies.hold_for) <=
                 later(knowledge.now, soon);
    case RulePhase::kFailing:
      return knowledge.now < later(state.failing_since, soon);
    case RulePhase::kAttempting:
      return true;
    case RulePhase::kExhausted:
      return false;
  }
  return false;
}

// Is another rule about to bring up the group?
bool is_brought_up_by_rule(const Group& group, RuleId asking, const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  return std::ranges::any_of(rules.strategies, [&](const Strategy& strategy) {
    return strategy.rule != asking && acts_soon(strategy.rule, knowledge) &&
           std::ranges::any_of(strategy.adaptations, [&](const Adaptation& a) {
             return a.group && &rules[*a.group] == &group;
           });
  });
}

// Its component lives, and is not active because its group is paused, is being brought up or down, or is to be brought up by
// another rule: there is nothing to repair in it. A rule that reads its lifecycle says so itself. A step that leaves a paused one as it is
// disturbs nothing.
std::optional<Invalid> not_active_with_group(const Strategy& strategy, const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  for (std::size_t i = 0; i < strategy.adaptations.size(); ++i) {
    const Adaptation& a = strategy.adaptations[i];
    const ComponentState& state = knowledge.components[a.component];
    const bool is_down = state.alive == true && state.lifecycle != Lifecycle::kActive;
    if (a.group || !is_down || diagnose::reads_lifecycle(strategy.rule, a.component, rules))
      continue;
    for (const Group& group : rules.groups) {
      if (std::ranges::find(group.members, a.component) == group.members.end()) continue;
      const GroupHealth health = health_of(group, knowledge.components, knowledge.now);
      if (health == GroupHealth::kInactive && !is_done_step(i, strategy, knowledge))
        return Invalid{a.component, "is not active: its group " + group.name + " is paused", true};
      if (health == GroupHealth::kChanging)
        return Invalid{a.component,
                       "is not active: its group " + group.name + " is being brought up or down",
                       true};
      if (is_brought_up_by_rule(group, strategy.rule, knowledge))
        return Invalid{a.component,
                       "is not active: its group " + group.name + " is to be brought up", true};
    }
  }
  return std::nullopt;
}

// Its WHEN condition is not true.
std::optional<Invalid> untimely_by_when(const Strategy& strategy, const Knowledge& knowledge) {
  if (strategy.when.empty()) return std::nullopt;
  const Slot when = evaluate_when(strategy, knowledge);
  if (when.known && when.b) return std::nullopt;
  return Invalid{strategy.adaptations.front().component,
                 when.known ? "its WHEN condition is false" : "its WHEN condition is unknown"};
}

// Why its adaptation at `place` cannot be carried out, or is pointless.
std::optional<Invalid> obstacle_to_part(const Strategy& strategy, std::size_t place,
                                        const Knowledge& knowledge) {
  const Adaptation& adaptation = strategy.adaptations[place];
  // The effect of an earlier adaptation of the same strategy is not known yet: start, then set a
  // parameter.
  for (std::size_t before = 0; before < place; ++before) {
    const bool is_same = strategy.adaptations[before].component == adaptation.component;
    if (is_same && !is_done_step(before, strategy, knowledge)) return std::nullopt;
  }
  if (cannot_be_reached(adaptation, knowledge))
    return Invalid{adaptation.component, knowledge.why_unheard(adaptation.component), true};
  if (std::string missing = missing_for(adaptation, knowledge); !missing.empty())
    return Invalid{adaptation.component, std::move(missing), true};
  if (is_done_step(place, strategy, knowledge)) return std::nullopt;
  const std::string& name = knowledge.rules[adaptation.component].name;
  const std::string reason = obstacle(adaptation, strategy.is_last_resort, knowledge);
  if (!reason.empty()) return Invalid{adaptation.component, name + " " + reason};
  // A last resort never waits for an answer. The request is valid again with the next one.
  const bool needs_answer = sends_request(adaptation) && !starts_member(adaptation, knowledge) &&
                            !strategy.is_last_resort;
  if (needs_answer && owes_answers(adaptation.component, knowledge))
    return Invalid{adaptation.component, "does not answer", true};
  return std::nullopt;
}

// Why it cannot be carried out now, or is pointless.
std::optional<Invalid> impossibility(const Strategy& strategy, const Knowledge& knowledge) {
  if (auto untimely = untimely_by_when(strategy, knowledge)) return untimely;
  if (auto needless = needless_start(strategy, knowledge)) return needless;
  bool changes_anything = false;
  for (std::size_t i = 0; i < strategy.adaptations.size(); ++i) {
    if (auto obstacle = obstacle_to_part(strategy, i, knowledge)) return obstacle;
    changes_anything |= !is_done_step(i, strategy, knowledge);
  }
  if (changes_anything) return std::nullopt;
  const Adaptation& first = strategy.adaptations.front();
  return Invalid{first.component, knowledge.rules[first.component].name + " " +
                                      obstacle(first, strategy.is_last_resort, knowledge)};
}

}  // namespace

std::optional<Invalid> invalidity(const Strategy& strategy, const Knowledge& knowledge) {
  if (strategy.is_last_resort)
    return Invalid{strategy.adaptations.front().component, "it is the last resort"};
  const StrategyId id(static_cast<std::size_t>(&strategy - knowledge.rules.strategies.data()));
  const bool is_exhausted = knowledge.states[strategy.rule].search.is_exhausted;
  if (is_exhausted && !knowledge.goes_on(id))
    return Invalid{strategy.adaptations.front().component,
                   "its rule is exhausted, and only exited processes are started again"};
  if (auto held = held_by_last_resort(strategy, knowledge)) return held;
  if (auto held = ends_what_is_held(strategy, knowledge)) return held;
  if (auto barred = barred_by_another(strategy, knowledge)) return barred;
  if (auto not_active = not_active_with_group(strategy, knowledge)) return not_active;
  if (auto deactivated = stays_deactivated(strategy, knowledge)) return deactivated;
  return impossibility(strategy, knowledge);
}

bool is_excluded_alone(Candidate& candidate, const Knowledge& knowledge) {
  const Strategy& strategy = knowledge.rules[candidate.strategy];
  const std::string& withheld = knowledge.withheld[candidate.strategy.index].reason;
  if (knowledge.states.is_tried(candidate.strategy)) {
    candidate.excluded = Condition::kTried;
  } else if (auto invalid = invalidity(strategy, knowledge)) {
    candidate.excluded = invalid->waits ? Condition::kUnheard : Condition::kInvalid;
    candidate.component = invalid->component;
    candidate.remark = std::move(invalid->reason);
  } else if (!withheld.empty()) {
    CULPRIT_ASSERT(!strategy.components.empty());
    candidate.excluded = Condition::kWithheld;
    candidate.component = strategy.components.front();
    candidate.remark = withheld;
  }
  return candidate.excluded.has_value();
}

LastResortParts parts_of_last_resort(const Strategy& strategy, const Knowledge& knowledge) {
  LastResortParts parts;
  if (const auto untimely = untimely_by_when(strategy, knowledge)) {
    parts.obstacle = untimely->reason;
    return parts;
  }
  std::size_t possible = 0;
  for (std::size_t i = 0; i < strategy.adaptations.size(); ++i) {
    const Adaptation& a = strategy.adaptations[i];
    const std::string& name = knowledge.rules[a.component].name;
    std::string& why = parts.obstacles.emplace_back();
    if (const auto holder = holder_against(strategy, a, knowledge)) {
      why = name + " " + held_by(*holder, knowledge.rules);
    } else if (const auto invalid = obstacle_to_part(strategy, i, knowledge)) {
      if (invalid->waits)
        why = name + " " + invalid->reason;
      else if (!holds_already(a, knowledge))
        why = invalid->reason;
    }
    if (why.empty()) ++possible;
    if (!why.empty() && parts.obstacle.empty()) parts.obstacle = why;
  }
  const std::size_t needed = strategy.has_steps() ? strategy.adaptations.size() : 1;
  if (possible >= needed) parts.obstacle.clear();
  return parts;
}

}  // namespace culprit::plan
