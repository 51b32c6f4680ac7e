#include "analyze/due_verdicts.h"

#include <algorithm>
#include <iterator>
#include <variant>
#include <vector>

#include "diagnose/stays_inactive.h"
#include "diagnose/timing.h"
#include "knowledge/group_health.h"

namespace culprit {
namespace {

// May the input's value come from the component? The sources of signals and diagnostics are
// unknown.
bool may_be_of(ComponentId component, const Input& input, const Knowledge& knowledge) {
  using Subject = Input::Subject;
  switch (input.subject()) {
    case Subject::kTopic:
      return knowledge.graph.publishes(component, knowledge.rules[input.topic]);
    case Subject::kComponent:
      return input.component == component;
    case Subject::kParameter:
      return knowledge.rules.parameters[input.parameter.index].component == component;
    case Subject::kSignal:
    case Subject::kDiagnostic:
      break;
  }
  return true;
}

}  // namespace

Time DueVerdicts::deadline(const Attempt& attempt) const {
  const Strategy& strategy = knowledge_.rules[attempt.strategy];
  const RuleId id = strategy.rule;
  const Duration impact =
      std::max(duration_of(strategy.impact, knowledge_.rules), knowledge_.latencies.patience(id));
  // A component that it started may begin late to show what the rule reads.
  const bool may_be_late = std::ranges::any_of(strategy.adaptations, [&](const Adaptation& a) {
    return launches(a) && knowledge_.rules[a.component].ready > Duration::zero();
  });
  const Time spoke = may_be_late && attempt.spoke != kNever ? attempt.spoke : kLongAgo;
  const Time given = std::max({later(attempt.effective, impact), shows_from(attempt), spoke,
                               knowledge_.signals.heard_again_by(id)});
  return later(given, knowledge_.signals.latency(id));
}

// A process that it has changed is gone or stopped, so nothing more is to be seen of it.
bool DueVerdicts::has_lost_a_process(const Attempt& attempt) const {
  const auto& adaptations = knowledge_.rules[attempt.strategy].adaptations;
  return std::ranges::any_of(adaptations, [&](const Adaptation& each) {
    const ComponentState& state = knowledge_.components[each.component];
    return each.type != AdaptationType::kStop && state.pid != 0 &&
           state.process != ProcessState::kRunning;
  });
}

bool DueVerdicts::has_spoken(const Attempt& attempt) const {
  const Strategy& strategy = knowledge_.rules[attempt.strategy];
  return std::ranges::none_of(strategy.adaptations, [&](const Adaptation& a) {
    return launches(a) && is_silent_since_its_start(a.component, strategy.rule);
  });
}

DueVerdicts::Verdict DueVerdicts::verdict(const Attempt& attempt, Time now) const {
  const RuleId id = knowledge_.rules[attempt.strategy].rule;
  const Slot& trigger = trigger_of(attempt);
  const auto awaited =
      is_about_whole_group(attempt.strategy) ? missing_group(id, now) : std::nullopt;
  if (knowledge_.rules[id].policies.on_change || (detector_.is_cleared(id, now) && !awaited))
    return Verdict::kSucceeds;
  if (!trigger.known && has_lost_a_process(attempt)) return Verdict::kFails;
  const bool is_suspended = attempt.stage == Attempt::Stage::kSuspended;
  const bool is_clearing = is_false(trigger) && !(awaited && is_left_down(*awaited, attempt, now));
  if (is_suspended || now < attempt.deadline || is_clearing) return Verdict::kNotYet;
  const bool is_certain = trigger.known || now >= later(attempt.deadline, kLostAfter) ||
                          holds_up_more_critical(attempt.strategy);
  return is_certain ? Verdict::kFails : Verdict::kNotYet;
}

Time DueVerdicts::next(const Attempt& attempt, Time now) const {
  Time next = kNever;
  const auto want = [&](Time at) {
    if (at > now) next = std::min(next, at);
  };
  const Time next_cycle = later(now, knowledge_.rules.cycle);
  if (attempt.stage == Attempt::Stage::kWaiting) {
    want(attempt.deadline);
    want(later(attempt.deadline, kLostAfter));
    // Until the wait ends; a more critical failure may come before.
    if (!trigger_of(attempt).known || shows_from(attempt) > now) want(next_cycle);
  }
  if (attempt.stage == Attempt::Stage::kSuspended) want(next_cycle);
  return next;
}

const Slot& DueVerdicts::trigger_of(const Attempt& attempt) const {
  return knowledge_.states[knowledge_.rules[attempt.strategy].rule].detection.trigger;
}

std::optional<GroupId> DueVerdicts::missing_group(RuleId id, Time now) const {
  for (const GroupId group : knowledge_.rules[id].groups) {
    const GroupHealth health = health_of(knowledge_.rules[group], knowledge_.components, now);
    if (health != GroupHealth::kActive && health != GroupHealth::kInactive) return group;
  }
  return std::nullopt;
}

// It brings up a group, or its rule reads the health of one: a member that works proves nothing.
bool DueVerdicts::is_about_whole_group(StrategyId id) const {
  const Strategy& strategy = knowledge_.rules[id];
  const auto reads_group = [&](InputId input) {
    const Input& read = knowledge_.rules[input];
    return read.kind == Input::Kind::kSignal &&
           std::holds_alternative<GroupId>(knowledge_.rules[read.signal].source);
  };
  return std::ranges::any_of(strategy.adaptations,
                             [](const Adaptation& a) { return a.group.has_value(); }) ||
         std::ranges::any_of(knowledge_.rules[strategy.rule].inputs, reads_group);
}

bool DueVerdicts::is_left_down(GroupId group, const Attempt& attempt, Time now) const {
  const GroupHealth health = health_of(knowledge_.rules[group], knowledge_.components, now);
  if (health == GroupHealth::kChanging) return false;
  return health != GroupHealth::kUnknown || now >= later(attempt.deadline, kLostAfter);
}

// A started component has to make the publishers that it had, for which it may open a device first.
// It has to discover its publishers; its subscribers have to discover it, too, where the rule reads
// from them. READY says how long it may take until its first message.
Time DueVerdicts::shows_from(const Attempt& attempt) const {
  const Strategy& strategy = knowledge_.rules[attempt.strategy];
  const auto is_read = [&](ComponentId component) {
    const auto& inputs = knowledge_.rules[strategy.rule].inputs;
    return std::ranges::any_of(
        inputs, [&](InputId id) { return may_be_of(component, knowledge_.rules[id], knowledge_); });
  };
  std::vector<ComponentId> hearing;
  Time speaks = kLongAgo;
  for (const Adaptation& adaptation : strategy.adaptations) {
    if (!launches(adaptation)) continue;
    hearing.push_back(adaptation.component);
    const ComponentState& started = knowledge_.components[adaptation.component];
    if (is_read(adaptation.component)) speaks = std::max(speaks, started.awaits_ends_until);
    if (is_silent_since_its_start(adaptation.component, strategy.rule))
      speaks = std::max(speaks, later(std::min(attempt.first_change, attempt.effective),
                                      knowledge_.rules[adaptation.component].ready));
    if (is_read(adaptation.component) && started.ends_back > started.node_seen)
      speaks = std::max(speaks, later(started.ends_back, knowledge_.finding));
    const auto& downstream = knowledge_.graph.downstream(adaptation.component);
    std::copy_if(downstream.begin(), downstream.end(), std::back_inserter(hearing), is_read);
  }
  const Time hears = std::min(knowledge_.can_hear_from(hearing), later(attempt.effective, kInputs));
  return std::max(hears, speaks);
}

// Does the rule wait for a topic of the component that nothing came on since its process began? It may make its
// publisher late.
bool DueVerdicts::is_silent_since_its_start(ComponentId component, RuleId rule) const {
  const Time begun = knowledge_.components[component].node_seen;
  bool is_silent = false;
  for (const InputId id : knowledge_.rules[rule].inputs) {
    const Input& input = knowledge_.rules[id];
    if (!diagnose::watches_a_topic(input)) continue;
    const bool has_publisher = knowledge_.graph.publisher_count(knowledge_.rules[input.topic]) > 0;
    if (has_publisher && !may_be_of(component, input, knowledge_)) continue;
    const auto& last = knowledge_.signals.rhythm(input.topic).last;
    if (last && *last >= begun) return false;
    is_silent = true;
  }
  return is_silent;
}

bool DueVerdicts::holds_up_more_critical(StrategyId strategy) const {
  const auto& adapted = knowledge_.rules[strategy].components;
  const auto criticality = [&](RuleId id) { return knowledge_.rules[id].policies.criticality; };
  const Criticality level = criticality(knowledge_.rules[strategy].rule);
  const auto adapts_it_too = [&](StrategyId other) {
    const auto& components = knowledge_.rules[other].components;
    return std::find_first_of(components.begin(), components.end(), adapted.begin(),
                              adapted.end()) != components.end();
  };
  const auto& active = knowledge_.states.active();
  return std::any_of(active.begin(), active.end(), [&](RuleId id) {
    const auto& strategies = knowledge_.rules[id].strategies;
    return criticality(id) > level && knowledge_.states[id].phase == RulePhase::kFailing &&
           std::any_of(strategies.begin(), strategies.end(), adapts_it_too);
  });
}

bool DueVerdicts::has_components_back(const Attempt& attempt) const {
  const auto& components = knowledge_.rules[attempt.strategy].components;
  return std::all_of(components.begin(), components.end(),
                     [&](ComponentId c) { return knowledge_.states.reservation(c) == nullptr; });
}

bool DueVerdicts::went_away_before(const Attempt& attempt) const {
  const RuleId id = knowledge_.rules[attempt.strategy].rule;
  const RuleState& state = knowledge_.states[id];
  return !knowledge_.rules[id].policies.on_change && is_false(state.detection.trigger) &&
         state.detection.trigger_since < attempt.first_change;
}

std::optional<ComponentId> DueVerdicts::unheard_behind(const Attempt& attempt) const {
  const Strategy& strategy = knowledge_.rules[attempt.strategy];
  const auto own = std::ranges::find_if(strategy.components,
                                        [&](ComponentId c) { return knowledge_.is_unheard(c); });
  return own != strategy.components.end() ? std::optional(*own)
                                          : knowledge_.unheard_behind(strategy.rule);
}

std::optional<std::string> DueVerdicts::why_no_attempt(const Attempt& attempt) const {
  for (const Adaptation& adaptation : knowledge_.rules[attempt.strategy].adaptations) {
    if (!launches(adaptation)) continue;
    const std::string& name = knowledge_.rules[adaptation.component].name;
    const ComponentState& state = knowledge_.components[adaptation.component];
    if (!attempt.obstacle.empty() && !state.start_missing.empty())
      return name + " cannot be started: " + state.start_missing;
    if (attempt.obstacle.empty() &&
        diagnose::stays_inactive(adaptation.component, knowledge_.rules[attempt.strategy],
                                 knowledge_))
      return name + " is there again, and inactive as before";
  }
  return std::nullopt;
}

}  // namespace culprit
