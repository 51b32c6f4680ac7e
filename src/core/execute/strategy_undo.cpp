// Takes back what a strategy changed that failed, in reverse order; says what cannot be taken back now, and what is
// owed to the component's next start.
#include <algorithm>
#include <utility>

#include "base/invariant.h"
#include "execute/strategy_executor.h"
#include "knowledge/held.h"

namespace culprit::execute {

// How the goal that was pursued last is taken back. A state that two steps change is brought
// back to where it was before the first. A step that gives back takes nothing.
void StrategyExecutor::note_undo(Run& run) {
  const Pursuit& pursuit = *run.pursuit;
  const Adaptation& adaptation = knowledge_.rules[run.strategy].adaptations[run.adaptation];
  if (adaptation.type == AdaptationType::kStop) {
    if (!pursuit.is_reached() || !is_undone_by_start(adaptation, knowledge_.rules)) return;
    const Lifecycle before = knowledge_.components[adaptation.component].intended_lifecycle;
    for (Goal& goal : starting_again(adaptation, before, knowledge_))
      run.undo.push_back({adaptation.component, std::move(goal)});
  } else if (pursuit.before() && !gives_back(run.adaptation, knowledge_.rules[run.strategy])) {
    auto goal = undoing(pursuit.goal(), adaptation.type, *pursuit.before());
    if (!goal) return;
    auto known = std::ranges::find_if(run.undo, [&](const Undo& each) {
      return each.component == pursuit.component() && are_of_one_thing(each.goal, *goal);
    });
    if (known == run.undo.end())
      known = run.undo.insert(known, Undo{pursuit.component(), std::move(*goal)});
    if (auto* parameter = std::get_if<ParameterGoal>(&known->goal))
      parameter->left = pursuit.left();
  }
}

bool StrategyExecutor::next_undo(Run& run, Time now) {
  for (; !run.undo.empty(); run.undo.pop_back()) {
    const Undo& undo = run.undo.back();
    const ComponentState& state = knowledge_.components[undo.component];
    const bool starts = std::holds_alternative<PresentGoal>(undo.goal);
    if (is_held_by_last_resort(undo)) continue;
    if (starts && (state.alive == true || (state.pid != 0 && state.process != ProcessState::kGone)))
      continue;  // it is there
    if (is_changed_by_another(undo)) {
      tell_left_out(run, "something else has changed it since", now);
      continue;
    }
    if (const auto missing = missing_for(run, undo)) {
      owe(undo, now);
      tell_left_out(run,
                    "it may depend on " + knowledge_.rules[missing->component].name + ", which " +
                        missing->why,
                    now);
      continue;
    }
    if (!starts && state.process == ProcessState::kGone) {
      undo_at_next_start(run.strategy, undo, now);
      continue;
    }
    run.pursuit.emplace(undo.goal, undo.component, now);
    return true;
  }
  write_.attempts.undone(run.strategy);
  write_.signals.touch(run.rule);
  return false;
}

// Its next undo is left out.
void StrategyExecutor::tell_left_out(const Run& run, const std::string& why, Time now) {
  const Undo& undo = run.undo.back();
  write_.events.tell(
      now, Undone{run.strategy,
                  knowledge_.rules[undo.component].name + ": " + describe(undo.goal) + ": " + why,
                  false});
}

// A person, or another program, has brought it to another state since. Where that is the one to go back to, nothing
// is to be done. A parameter is looked at when it is undone.
bool StrategyExecutor::is_changed_by_another(const Undo& undo) const {
  const auto* lifecycle = std::get_if<LifecycleGoal>(&undo.goal);
  const ComponentState& state = knowledge_.components[undo.component];
  return lifecycle != nullptr && state.brought && state.brought->is_changed &&
         state.lifecycle != lifecycle->target;
}

// A restart that was interrupted, or failed, may have left its component inactive. No person did that.
void StrategyExecutor::owe_restart(const Run& run, Time now) {
  const auto& adaptations = knowledge_.rules[run.strategy].adaptations;
  if (run.is_undoing || run.adaptation >= adaptations.size()) return;
  const Adaptation& adaptation = adaptations[run.adaptation];
  const bool has_changed = run.goal > 0 || (run.pursuit && run.pursuit->has_changed_anything());
  const Lifecycle state = knowledge_.components[adaptation.component].lifecycle;
  const bool fell_back = state == Lifecycle::kUnconfigured || state == Lifecycle::kFinalized;
  if (adaptation.type == AdaptationType::kRestart && !run.goals.empty() && has_changed &&
      !fell_back)
    owe({adaptation.component, LifecycleGoal{Lifecycle::kActive, {}}}, now);
}

// It stays deactivated: the next try gives it back, be it that of the next culprit.
void StrategyExecutor::owe(const Undo& undo, Time now) {
  const auto* lifecycle = std::get_if<LifecycleGoal>(&undo.goal);
  if (lifecycle == nullptr || lifecycle->target != Lifecycle::kActive) return;
  write_.components.owe_activation(undo.component, now);
  write_.events.tell(
      now, LifecycleIntended{undo.component,
                             knowledge_.components[undo.component].intended_lifecycle, true});
}

// A last resort wants it deactivated, as it is already: what an earlier strategy owes is not given back any more.
void StrategyExecutor::owe_no_more(ComponentId component, Time now) {
  ComponentState& state = write_.components[component];
  if (!state.is_to_be_given_back()) return;
  state.brought = Brought{Lifecycle::kInactive};
  write_.events.tell(now, LifecycleIntended{component, state.intended_lifecycle});
}

// The component that keeps another one, which the strategy took down, from being brought up again: one
// that was adapted after it, or that it depends on, and that is down or could not be brought up.
std::optional<StrategyExecutor::Missing> StrategyExecutor::missing_for(const Run& run,
                                                                       const Undo& undo) const {
  const Strategy& strategy = knowledge_.rules[run.strategy];
  const auto* lifecycle = std::get_if<LifecycleGoal>(&undo.goal);
  const bool activates = lifecycle != nullptr && lifecycle->target == Lifecycle::kActive &&
                         knowledge_.components[undo.component].lifecycle != Lifecycle::kActive;
  const bool starts = std::holds_alternative<PresentGoal>(undo.goal);
  if (strategy.components.size() < 2 || (!activates && !starts)) return std::nullopt;
  const auto is_down = [&](ComponentId c) {
    return c != undo.component && knowledge_.components[c].alive == false;
  };
  const auto& suppliers = knowledge_.graph.upstream(undo.component);
  const auto is_upstream = [&](ComponentId c) {
    return std::ranges::find(suppliers, c) != suppliers.end();
  };
  bool is_later = false;
  for (std::size_t i = 0; i < strategy.adaptations.size(); ++i) {
    const Adaptation& adaptation = strategy.adaptations[i];
    const bool brings_up = adaptation.type == AdaptationType::kActivate ||
                           adaptation.type == AdaptationType::kRestart || launches(adaptation);
    const bool has_failed = i == run.adaptation && brings_up;
    if (adaptation.component == undo.component) {
      is_later = true;
    } else if (is_later && is_down(adaptation.component)) {
      return Missing{adaptation.component, "is down"};
    } else if (is_later && adaptation.type == AdaptationType::kActivate &&
               knowledge_.components[adaptation.component].lifecycle == Lifecycle::kInactive &&
               is_upstream(adaptation.component)) {
      return Missing{adaptation.component, "is inactive"};
    } else if (is_later && has_failed) {
      return Missing{adaptation.component, "could not be brought up"};
    }
  }
  const auto upstream = knowledge_.graph.first_upstream(undo.component, is_down);
  return upstream ? std::optional(Missing{*upstream, "is down"}) : std::nullopt;
}

// A last resort has changed the same since, and that stays.
bool StrategyExecutor::is_held_by_last_resort(const Undo& undo) const {
  Adaptation change;
  change.component = undo.component;
  if (const auto* parameter = std::get_if<ParameterGoal>(&undo.goal)) {
    change.type = AdaptationType::kSetParameter;
    change.subject = parameter->name;
  } else if (const auto* lifecycle = std::get_if<LifecycleGoal>(&undo.goal)) {
    change.type = lifecycle->target == Lifecycle::kActive ? AdaptationType::kActivate
                                                          : AdaptationType::kDeactivate;
  } else if (const auto* mode = std::get_if<ModeGoal>(&undo.goal)) {
    change.type = AdaptationType::kChangeMode;
    change.subject = mode->mode;
  } else if (std::holds_alternative<PresentGoal>(undo.goal)) {
    change.type = AdaptationType::kStart;
  } else {
    return false;
  }
  return holder_of(change, knowledge_).has_value();
}

// No process is there to be asked. The next process may start with the values of the last one: many
// nodes keep their parameters.
void StrategyExecutor::undo_at_next_start(StrategyId strategy, const Undo& undo, Time now) {
  if (const auto* lifecycle = std::get_if<LifecycleGoal>(&undo.goal)) {
    write_.components.intend_lifecycle(undo.component, lifecycle->target, now, write_.events);
  } else if (const auto* parameter = std::get_if<ParameterGoal>(&undo.goal)) {
    forget_owed(undo.component, parameter->name);
    owed_.push_back({strategy, undo});
    // The next process starts with a value of its own.
    std::get<ParameterGoal>(owed_.back().undo.goal).left.reset();
  }
}

// Values to be undone in a process that `adaptation` starts become its last goals.
void StrategyExecutor::take_owed(const Adaptation& adaptation, std::vector<Goal>& goals) {
  if (adaptation.type != AdaptationType::kRedeploy && adaptation.type != AdaptationType::kStart)
    return;
  std::erase_if(owed_, [&](Owed& owed) {
    if (owed.undo.component != adaptation.component) return false;
    goals.push_back(std::move(owed.undo.goal));
    return true;
  });
}

// A process that somebody else started has the values that they want, and a person may have changed
// them since. So culprit reports the pending undo, and does not set it at some redeploy much later.
void StrategyExecutor::forget_what_others_started(Time now) {
  std::erase_if(owed_, [&](const Owed& owed) {
    const ComponentId component = owed.undo.component;
    if (knowledge_.components[component].process == ProcessState::kGone) return false;
    const std::string what = knowledge_.rules[component].name + ": " + describe(owed.undo.goal);
    write_.events.tell(
        now, Undone{owed.strategy, what + ": something else had started it again", false});
    return true;
  });
}

void StrategyExecutor::forget_owed(ComponentId component, const std::string& parameter) {
  std::erase_if(owed_, [&](const Owed& owed) {
    return owed.undo.component == component &&
           std::get<ParameterGoal>(owed.undo.goal).name == parameter;
  });
}

void StrategyExecutor::finish_undo(Run& run, Time now) {
  const Pursuit& pursuit = *run.pursuit;
  // Another change would count as undone.
  CULPRIT_ASSERT(!run.undo.empty() && run.undo.back().component == pursuit.component());
  const bool reached = pursuit.is_reached();
  if (reached) {
    notes_.reached_lifecycle(pursuit, now);
  } else {
    owe(run.undo.back(), now);
  }
  // A mode that is back by itself was set back, and that is remembered.
  if (std::holds_alternative<ModeGoal>(pursuit.goal()) && pursuit.has_changed_anything())
    write_.rivals.forget(pursuit.component());
  // A value that came back by itself was not undone.
  if (!reached || pursuit.has_changed_anything()) {
    const std::string what =
        knowledge_.rules[pursuit.component()].name + ": " + describe(pursuit.goal());
    write_.events.tell(
        now, Undone{run.strategy, reached ? what : what + ": " + pursuit.remark(), reached});
  }
  run.undo.pop_back();
  run.pursuit.reset();
}

}  // namespace culprit::execute
