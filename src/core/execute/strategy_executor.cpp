#include "execute/strategy_executor.h"

#include <algorithm>
#include <utility>

#include "base/invariant.h"
#include "diagnose/known_down.h"
#include "knowledge/ambiguity.h"
#include "knowledge/held.h"

namespace culprit::execute {

namespace {

// The adaptation that an undo of the component takes back; by then, the run may be past all of them. If the rules
// were changed since, the strategy may adapt the component no more: then `reached`.
std::size_t taken_back(ComponentId component, const std::vector<Adaptation>& all,
                       std::size_t reached) {
  const auto last = std::find_if(all.rbegin(), all.rend(), [&](const Adaptation& each) {
    return each.component == component;
  });
  if (last == all.rend()) return std::min(reached, all.size() - 1);
  return static_cast<std::size_t>(all.rend() - last) - 1;
}

}  // namespace

StrategyExecutor::StrategyExecutor(const Knowledge& knowledge, Writes writes)
    : knowledge_(knowledge),
      write_(writes),
      notes_(knowledge, writes.components, writes.rivals, writes.events) {}

StrategyExecutor::~StrategyExecutor() = default;

void StrategyExecutor::begin(StrategyId strategy, Time now, std::vector<std::string> obstacles) {
  const Strategy& begun = knowledge_.rules[strategy];
  CULPRIT_ASSERT(begun.is_last_resort ||
                 std::none_of(begun.components.begin(), begun.components.end(), [&](ComponentId c) {
                   return knowledge_.states.reservation(c) != nullptr;
                 }));
  write_.attempts.begin(strategy, now);
  add_run(strategy).obstacles = std::move(obstacles);
}

void StrategyExecutor::give_back(StrategyId strategy, ComponentId component, Time now) {
  write_.attempts.give_back(strategy, now);
  Run& run = add_run(strategy);
  run.is_undoing = true;
  const auto& adaptations = knowledge_.rules[strategy].adaptations;
  const auto place = std::ranges::find(adaptations, component, &Adaptation::component);
  CULPRIT_ASSERT(place != adaptations.end());
  run.adaptation = static_cast<std::size_t>(place - adaptations.begin());
  run.undo.push_back({component, LifecycleGoal{Lifecycle::kActive, {}}});
}

StrategyExecutor::Run& StrategyExecutor::add_run(StrategyId strategy) {
  const RuleId rule = knowledge_.rules[strategy].rule;
  std::erase_if(runs_, [&](const Run& old) {
    return old.rule == rule && knowledge_.rules[old.strategy].is_last_resort ==
                                   knowledge_.rules[strategy].is_last_resort;
  });
  Run& run = runs_.emplace_back();
  run.rule = rule;
  run.strategy = strategy;
  return run;
}

void StrategyExecutor::resume(Interrupted interrupted, Time now, Time from) {
  CULPRIT_ASSERT(
      std::all_of(runs_.begin(), runs_.end(), [](const Run& r) { return r.interrupted; }));
  // An answer to a request of the earlier process must not be taken for one to ours.
  for (const Interrupted::Request& request : interrupted.requests)
    last_command_ = std::max(last_command_, request.command.id.number);
  // It is over: its components are free.
  if (interrupted.has_failed && undo_of(interrupted, knowledge_).empty()) return;
  write_.attempts.resume(interrupted.strategy, now);
  Run& run = add_run(interrupted.strategy);
  run.interrupted = std::move(interrupted);
  run.from = from;
}

// Gives false while a resumed attempt has to wait, or if it cannot go on.
bool StrategyExecutor::take_up(Run& run, Time now) {
  if (!run.interrupted) return true;
  if (now < run.from) return false;
  const Interrupted interrupted = *std::exchange(run.interrupted, std::nullopt);
  write_.events.tell(now, StrategyResumed{run.strategy});
  run.undo = undo_of(interrupted, knowledge_);
  if (interrupted.has_failed) {
    run.adaptation = interrupted.adaptations_done;
    write_.attempts.undo(run.strategy);
    write_.signals.touch(run.rule);
    return true;
  }
  Resumption rest = resumption_of(interrupted, knowledge_);
  run.adaptation = rest.adaptation;
  run.goals = std::move(rest.goals);
  if (rest.obstacle.empty()) return true;
  obstruct(run, rest.obstacle, rest.obstacle, now);
  return false;
}

void StrategyExecutor::restart(Time now) {
  for (Run& run : runs_) {
    if (run.pursuit) run.pursuit->restart(now);
  }
  forget_questions();
  unsure_until_ = later(now, kUnsure);
}

void StrategyExecutor::ask(ComponentId component, StrategyId strategy, Duration timeout, Time now,
                           std::vector<Command>& commands) {
  Questioned& questioned = write_.components[component].questioned;
  questioned.at = now;
  questioned.is_open = true;
  std::erase_if(questions_, [&](const Question& old) { return old.component == component; });
  questions_.push_back({{++last_command_}, component});
  commands.push_back({questions_.back().command, component, Probe{}, timeout, {strategy}});
}

void StrategyExecutor::forget_questions() {
  // Whether they would have been answered is unknown.
  for (const Question& each : questions_) {
    Questioned& questioned = write_.components[each.component].questioned;
    questioned.is_open = false;
    questioned.unanswered.reset();
  }
  questions_.clear();
}

std::optional<ComponentId> StrategyExecutor::proven_by(const Reply& reply) const {
  const auto question = std::ranges::find(questions_, reply.command, &Question::command);
  const bool is_proven = question != questions_.end() && reply.outcome == Outcome::kDone &&
                         is_of_present_process(*question);
  return is_proven ? std::optional(question->component) : std::nullopt;
}

// A process that began since then was not asked.
bool StrategyExecutor::is_of_present_process(const Question& question) const {
  return knowledge_.components[question.component].questioned.is_open;
}

// A component that could not be asked, or that never answered, may work all the same.
void StrategyExecutor::note_answer(const Question& question, Outcome outcome) {
  if (!is_of_present_process(question)) return;
  ComponentState& state = write_.components[question.component];
  Questioned& questioned = state.questioned;
  questioned.is_open = false;
  if (outcome == Outcome::kDone) return;  // the monitor notes it
  if (outcome == Outcome::kTimedOut && knowledge_.now < unsure_until_)
    return questioned.unanswered.reset();
  questioned.is_pointless = outcome != Outcome::kTimedOut || !state.answers_probes;
  if (!questioned.unanswered && !questioned.is_pointless) questioned.unanswered = questioned.at;
}

void StrategyExecutor::answered(const Reply& reply, Time now) {
  const auto question = std::ranges::find(questions_, reply.command, &Question::command);
  if (question != questions_.end()) {
    note_answer(*question, reply.outcome);
    questions_.erase(question);
    return;
  }
  for (Run& run : runs_) {
    if (run.pursuit && run.pending == reply.command) {
      run.pending = {};
      run.pursuit->answered(reply, now);
      return;
    }
  }
}

void StrategyExecutor::advance(Time now, std::vector<Command>& commands) {
  if (!owed_.empty()) forget_what_others_started(now);
  // An attempt that is over left its rule; nothing of it is left to do.
  std::erase_if(runs_, [&](const Run& run) {
    if (attempt_of(run) != nullptr) return false;
    owe_restart(run, now);
    return true;
  });
  for (Run& run : runs_) advance(run, now, commands);
}

void StrategyExecutor::advance(Run& run, Time now, std::vector<Command>& commands) {
  if (!take_up(run, now)) return;
  const Attempt::Stage stage = attempt_of(run)->stage;
  if (stage == Attempt::Stage::kUndoing && !run.is_undoing) {
    owe_restart(run, now);
    run.is_undoing = true;
    run.pursuit.reset();
  }
  const bool is_at_rest = stage == Attempt::Stage::kWaiting ||
                          stage == Attempt::Stage::kSuspended || stage == Attempt::Stage::kOver;
  const bool may_start_again = stage == Attempt::Stage::kWaiting;
  if (is_at_rest && !(may_start_again && start_again(run, now))) {
    if (may_start_again) fail_with_lost_process(run);
    return;
  }
  // The analysis has not taken it from here yet.
  if (!attempt_of(run)->obstacle.empty() && !run.is_undoing) return;
  while (run.pursuit || (run.is_undoing ? next_undo(run, now) : next_goal(run, now))) {
    const bool had_changed = run.pursuit->has_changed_anything();
    if (run.pending == CommandId{} || run.pursuit->next_deadline() <= now ||
        run.pursuit->is_lost(knowledge_) || run.pursuit->must_insist(knowledge_)) {
      if (auto request = run.pursuit->advance(knowledge_, now)) {
        // A strategy that has failed would go on changing the robot.
        CULPRIT_ASSERT(run.is_undoing || attempt_of(run)->obstacle.empty());
        run.pending = {++last_command_};
        if (std::holds_alternative<StopProcess>(*request))
          write_.components[run.pursuit->component()].culprit_raised = kLongAgo;
        notes_.sends(*run.pursuit, *request, now);
        commands.push_back({run.pending, run.pursuit->component(), *request,
                            run.pursuit->timeout(*request), purpose_of(run)});
      }
    }
    if (!had_changed && run.pursuit->has_changed_anything()) note_change(run, now);
    if (run.pursuit->is_under_way()) return;
    run.is_undoing ? finish_undo(run, now) : finish_goal(run, now);
    if (!attempt_of(run)->obstacle.empty() && !run.is_undoing)
      return;  // the analysis takes it from here
  }
}

Purpose StrategyExecutor::purpose_of(const Run& run) const {
  const Pursuit& pursuit = *run.pursuit;
  const auto& adaptations = knowledge_.rules[run.strategy].adaptations;
  const std::size_t adaptation = run.is_undoing
                                     ? taken_back(pursuit.component(), adaptations, run.adaptation)
                                     : run.adaptation;
  Purpose purpose{run.strategy, static_cast<std::uint32_t>(adaptation), run.is_undoing};
  const bool is_process = std::holds_alternative<GoneGoal>(pursuit.goal()) ||
                          std::holds_alternative<PresentGoal>(pursuit.goal());
  if (is_process) {
    purpose.before = knowledge_.components[pursuit.component()].intended_lifecycle;
  } else if (pursuit.before()) {
    purpose.before = pursuit.before()->value;
  }
  return purpose;
}

// Sets out for the next goal; gives false if the attempt has none left.
bool StrategyExecutor::next_goal(Run& run, Time now) {
  const auto& adaptations = knowledge_.rules[run.strategy].adaptations;
  while (run.adaptation < adaptations.size()) {
    const Adaptation& adaptation = adaptations[run.adaptation];
    if (run.goals.empty()) {
      if (leaves_out(run)) continue;
      if (const auto other = deactivated_meanwhile(run)) {
        write_.attempts.make_ambiguous(run.strategy);
        const std::string reason = knowledge_.rules[*other].name +
                                   " was deactivated meanwhile, by something else: a person, or "
                                   "the manager";
        obstruct(run, reason, reason, now);
        return false;
      }
      const bool is_needless = has_nothing_to_do(run, now);
      auto goals = is_needless ? std::vector<Goal>() : goals_of(run, now);
      if (!goals) {
        if (goes_past(run, goals.error(), goals.error(), now)) continue;
        return false;
      }
      if (is_needless) run.remark = "nothing to do";
      run.goals = std::move(*goals);
      take_owed(adaptation, run.goals);
      run.goal = 0;
      if (adaptation.begins_step) run.started = kNever;
    }
    if (run.goal < run.goals.size()) {
      Goal& goal = run.goals[run.goal];
      const auto* lifecycle = std::get_if<LifecycleGoal>(&goal);
      if (lifecycle != nullptr && launches(adaptation))
        goal = bringing_up(adaptation, lifecycle->target, knowledge_);
      if (auto* present = std::get_if<PresentGoal>(&goal)) {
        run.started = std::min(run.started, now);
        present->tries_until = later(run.started, knowledge_.rules[adaptation.component].ready);
      }
      run.pursuit.emplace(goal, adaptation.component, now,
                          knowledge_.rules[run.strategy].is_last_resort);
      return true;
    }
    write_.events.tell(now, AdaptationDone{run.strategy, run.adaptation, run.remark});
    note_begun_anew(run, now);
    if (adaptation.group) run.brought_up.push_back({adaptation.component, now});
    run.goals.clear();
    run.remark.clear();
    ++run.adaptation;
  }
  if (run.missed.empty())
    write_.attempts.took_effect(run.strategy, now);
  else
    write_.attempts.obstruct(run.strategy, run.missed);
  write_.signals.touch(run.rule);
  return false;
}

Expected<std::vector<Goal>> StrategyExecutor::goals_of(const Run& run, Time now) {
  const Strategy& strategy = knowledge_.rules[run.strategy];
  const Adaptation& adaptation = strategy.adaptations[run.adaptation];
  const ComponentState& state = knowledge_.components[adaptation.component];
  if (is_managed_still(run)) return std::vector<Goal>();
  const bool is_done = strategy.is_last_resort && !strategy.has_steps() &&
                       adaptation.type == AdaptationType::kDeactivate && is_inactive_anyway(state);
  if (!is_done) return execute::goals_of(adaptation, knowledge_);
  // The process that takes its place is not brought up further either.
  if (state.intended_lifecycle != Lifecycle::kUnknown)
    write_.components.intend_lifecycle(adaptation.component, Lifecycle::kInactive, now,
                                       write_.events);
  owe_no_more(adaptation.component, now);
  return std::vector<Goal>();
}

// A part of a last resort that had an obstacle when it was begun.
bool StrategyExecutor::leaves_out(Run& run) {
  if (run.adaptation >= run.obstacles.size() || run.obstacles[run.adaptation].empty()) return false;
  if (run.missed.empty()) run.missed = run.obstacles[run.adaptation];
  ++run.adaptation;
  return true;
}

// The adaptation could not be carried out. Does the strategy go on all the same?
bool StrategyExecutor::goes_past(Run& run, const std::string& obstacle, const std::string& reason,
                                 Time now) {
  const Strategy& strategy = knowledge_.rules[run.strategy];
  if (!strategy.is_last_resort || strategy.has_steps()) {
    obstruct(run, obstacle, reason, now);
    return false;
  }
  write_.events.tell(now, AdaptationFailed{run.strategy, run.adaptation, reason});
  if (run.missed.empty()) run.missed = obstacle;
  run.goals.clear();
  run.remark.clear();
  ++run.adaptation;
  return true;
}

// A step that would take down what is down already; or that would give back what no step has taken. A component
// that died meanwhile is not brought up here: whatever starts it again does that.
bool StrategyExecutor::has_nothing_to_do(const Run& run, Time now) {
  const Strategy& strategy = knowledge_.rules[run.strategy];
  const Adaptation& adaptation = strategy.adaptations[run.adaptation];
  const ComponentState& state = knowledge_.components[adaptation.component];
  // One that is said to be inactive is looked at: that may have changed.
  if (strategy.has_steps() && adaptation.type == AdaptationType::kDeactivate)
    return state.is_at_rest() && (state.alive == false || state.lifecycle != Lifecycle::kInactive);
  // No record is kept of what a last resort has taken.
  if (strategy.is_last_resort || !gives_back(run.adaptation, strategy)) return false;
  if (!has_taken(run, adaptation.component)) return true;
  if (state.alive != false) return false;
  write_.components.intend_lifecycle(adaptation.component, Lifecycle::kActive, now, write_.events);
  return true;
}

// Whether this try has deactivated it, or an earlier one that could not activate it again; and nothing else has
// changed that.
bool StrategyExecutor::has_taken(const Run& run, ComponentId component) const {
  const ComponentState& state = knowledge_.components[component];
  if (state.is_to_be_given_back()) return true;
  const bool is_changed = state.brought && state.brought->is_changed;
  return !is_changed && std::ranges::any_of(run.undo, [&](const Undo& undo) {
    return undo.component == component && std::holds_alternative<LifecycleGoal>(undo.goal);
  });
}

// A member of a group that was brought up, and is not up any more though its process lives: to bring it up
// again would be a fight with whoever did that.
std::optional<ComponentId> StrategyExecutor::deactivated_meanwhile(const Run& run) const {
  for (const Run::BroughtUp& each : run.brought_up) {
    const ComponentState& state = knowledge_.components[each.component];
    const bool is_down =
        state.lifecycle == Lifecycle::kInactive || state.lifecycle == Lifecycle::kUnconfigured;
    if (is_down && state.alive == true && state.lifecycle_since > each.at &&
        state.node_seen <= each.at)
      return each.component;
  }
  return std::nullopt;
}

// The manager of a group in which nothing had to be changed: it has brought up all of them by itself.
bool StrategyExecutor::is_managed_still(const Run& run) const {
  const Adaptation& adaptation = knowledge_.rules[run.strategy].adaptations[run.adaptation];
  return adaptation.group && adaptation.type == AdaptationType::kRedeploy &&
         knowledge_.components[adaptation.component].alive == true &&
         attempt_of(run)->first_change == kNever;
}

// Consumers may show the gap of a restart after it is over.
void StrategyExecutor::note_begun_anew(const Run& run, Time now) {
  const Adaptation& adaptation = knowledge_.rules[run.strategy].adaptations[run.adaptation];
  if (adaptation.type != AdaptationType::kRestart && adaptation.type != AdaptationType::kRedeploy)
    return;
  const BegunAnew done{run.strategy, std::min(attempt_of(run)->first_change, now), now};
  write_.components[adaptation.component].begun_anew = done;
  for (const ComponentId other : knowledge_.components[adaptation.component].ends_with)
    write_.components[other].begun_anew = done;
}

// A process that was there, and ended before its component's READY was over, is started again: that is
// a try of the same attempt.
bool StrategyExecutor::start_again(Run& run, Time now) {
  if (run.started == kNever) return false;
  const auto& adaptations = knowledge_.rules[run.strategy].adaptations;
  for (std::size_t i = 0; i < adaptations.size(); ++i) {
    const Adaptation& adaptation = adaptations[i];
    const Time until = later(run.started, knowledge_.rules[adaptation.component].ready);
    if (!launches(adaptation) || now >= until || !knowledge_.is_known_gone(adaptation.component))
      continue;
    auto goals = execute::goals_of(adaptation, knowledge_);
    if (!goals) return false;
    std::erase_if(*goals, [](const Goal& goal) { return std::holds_alternative<GoneGoal>(goal); });
    for (Goal& goal : *goals) {
      if (auto* present = std::get_if<PresentGoal>(&goal))
        present->not_before =
            std::min(until, later(now, PresentGoal::kPause * (1 << std::min(run.starts, 10))));
    }
    ++run.starts;
    run.adaptation = i;
    run.goals = std::move(*goals);
    run.goal = 0;
    write_.attempts.adapts_again(run.strategy);
    return true;
  }
  return false;
}

// It took effect in a process that exited or is stopped since, and that culprit can replace: its effect is lost, and
// the replacement must not wait for the verdict. The outcome proves nothing, but it counts as an attempt: the strategy
// may have ended the process.
void StrategyExecutor::fail_with_lost_process(const Run& run) {
  const RuleSet& rules = knowledge_.rules;
  const Strategy& strategy = rules[run.strategy];
  if (strategy.is_last_resort) return;
  for (std::size_t i = 0; i < strategy.adaptations.size(); ++i) {
    const Adaptation& adaptation = strategy.adaptations[i];
    const ComponentId component = adaptation.component;
    const bool needs_no_process = adaptation.type == AdaptationType::kStop ||
                                  adaptation.type == AdaptationType::kDeactivate ||
                                  gives_back(i, strategy);
    const bool brings_it_back = adaptation.group || diagnose::replaces(strategy, component);
    if (needs_no_process || brings_it_back || !rules[component].can_start() ||
        !diagnose::is_known_down(component, knowledge_))
      continue;
    const bool is_stopped = knowledge_.components[component].process == ProcessState::kStopped;
    write_.attempts.make_ambiguous(run.strategy);
    write_.attempts.adapts_again(run.strategy);
    write_.attempts.obstruct(run.strategy,
                             rules[component].name + (is_stopped ? " is stopped" : " exited"));
    return write_.signals.touch(run.rule);
  }
}

void StrategyExecutor::finish_goal(Run& run, Time now) {
  CULPRIT_ASSERT(run.goal < run.goals.size());  // its proof would be taken for another goal's
  const Pursuit& pursuit = *run.pursuit;
  const Adaptation& adaptation = knowledge_.rules[run.strategy].adaptations[run.adaptation];
  // A last resort is to last, even after its failure has cleared.
  const bool is_to_last = knowledge_.rules[run.strategy].is_last_resort;
  notes_.ended(pursuit);
  // Members that are up stay up: a part of the group is better than nothing.
  if (!is_to_last && !adaptation.group && pursuit.has_changed_anything()) note_undo(run);
  if (pursuit.is_reached()) {
    // Where it was brought last counts; a restart takes it through another state.
    const auto rest = run.goals.begin() + static_cast<std::ptrdiff_t>(run.goal) + 1;
    const bool is_last = std::none_of(rest, run.goals.end(), [](const Goal& goal) {
      return std::holds_alternative<LifecycleGoal>(goal);
    });
    if (is_last) notes_.reached_lifecycle(pursuit, now);
    const auto* lifecycle = std::get_if<LifecycleGoal>(&pursuit.goal());
    if (is_to_last && lifecycle != nullptr && lifecycle->target == Lifecycle::kInactive)
      owe_no_more(pursuit.component(), now);
    if (const auto* parameter = std::get_if<ParameterGoal>(&pursuit.goal()))
      forget_owed(pursuit.component(), parameter->name);
    // The manager of a group goes on being the driver of its members.
    if (launches(adaptation) || (!adaptation.group && notes_.is_first_rise(pursuit)))
      notes_.came_up(pursuit, now);
    if (!pursuit.remark().empty()) run.remark = pursuit.remark();
    notes_.reached_mode(pursuit, now);
    ++run.goal;
  } else if (!replace_hung_member(run) && !start_again(run, now)) {
    if (pursuit.met_rival()) note_rival(run, now);
    if (launches(adaptation) && pursuit.took_too_long()) notes_.took_too_long(pursuit, now);
    goes_past(run, knowledge_.rules[pursuit.component()].name + ": " + pursuit.remark(),
              pursuit.remark(), now);
  }
  run.pursuit.reset();
}

// A member of a group may hang unnoticed, because other threads of its process work. The repair of the group finds
// it, and replaces it once.
bool StrategyExecutor::replace_hung_member(Run& run) const {
  if (!run.pursuit->found_hung()) return false;
  const Adaptation& adaptation = knowledge_.rules[run.strategy].adaptations[run.adaptation];
  run.goals = replacing_hung_member(adaptation, knowledge_);
  run.goal = 0;
  return true;
}

void StrategyExecutor::note_change(Run& run, Time now) {
  if (run.is_undoing || attempt_of(run)->first_change != kNever) return;
  write_.attempts.change_begins(run.strategy, now);
  mark_ambiguous(knowledge_, run.strategy, write_.attempts, write_.outcomes);
}

void StrategyExecutor::note_rival(const Run& run, Time now) {
  const ComponentId system = run.pursuit->component();
  write_.rivals.leave_alone(system, now);
  write_.events.tell(now, RivalSeen{system});
  write_.attempts.make_ambiguous(run.strategy);  // that nothing was tried proves nothing
}

const Attempt* StrategyExecutor::attempt_of(const Run& run) const {
  return knowledge_.states.attempt_of(run.strategy);
}

// The adaptation could not be carried out; the analysis takes it from here.
void StrategyExecutor::obstruct(const Run& run, std::string obstacle, const std::string& reason,
                                Time now) {
  write_.attempts.obstruct(run.strategy, std::move(obstacle));
  write_.events.tell(now, AdaptationFailed{run.strategy, run.adaptation, reason});
  write_.signals.touch(run.rule);
}

Time StrategyExecutor::next_deadline() const {
  Time next = kNever;
  for (const Run& run : runs_) {
    if (attempt_of(run) == nullptr) continue;
    if (run.pursuit) next = std::min(next, run.pursuit->next_deadline());
    if (run.interrupted) next = std::min(next, run.from);
  }
  return next;
}

}  // namespace culprit::execute
