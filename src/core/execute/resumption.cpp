#include "execute/resumption.h"

#include <algorithm>

#include "base/invariant.h"

namespace culprit::execute {
namespace {

using Sent = std::vector<const Interrupted::Request*>;

// The requests of the adaptation that was under way.
Sent sent_for(const Interrupted& interrupted) {
  Sent sent;
  for (const Interrupted::Request& request : interrupted.requests) {
    const Purpose& purpose = request.command.purpose;
    if (!purpose.undoes && purpose.adaptation == interrupted.adaptations_done)
      sent.push_back(&request);
  }
  return sent;
}

template <class Request>
const Interrupted::Request* last_of(const Sent& sent) {
  const auto found = std::find_if(sent.rbegin(), sent.rend(), [](const auto* request) {
    return std::holds_alternative<Request>(request->command.what);
  });
  return found == sent.rend() ? nullptr : *found;
}

// The process of a component is, or was about to be, replaced.
std::vector<Goal> goals_of_process(const Sent& sent, const Adaptation& adaptation,
                                   const Knowledge& knowledge) {
  CULPRIT_ASSERT(!sent.empty());  // a process that nothing was asked of would be replaced
  const auto* stop = last_of<StopProcess>(sent);
  const bool is_started = last_of<StartProcess>(sent) != nullptr;
  const int old_pid = stop != nullptr ? std::get<StopProcess>(stop->command.what).pid : 0;
  // culprit cannot see from here whether another process took its place on another computer. Its
  // owner there was asked to end and to start it, and is not asked again.
  const bool is_elsewhere = !knowledge.rules[adaptation.component].host().empty();
  const bool is_to_stop = adaptation.type == AdaptationType::kStop;
  std::vector<Goal> goals;
  if (!is_started && stop != nullptr && (is_to_stop || !is_elsewhere))
    goals.push_back(GoneGoal{old_pid});
  if (is_to_stop) return goals;
  PresentGoal back{old_pid};
  if (is_elsewhere) back.instead_of_seen = kLongAgo;
  goals.push_back(back);
  if (adaptation.group && adaptation.type == AdaptationType::kActivate) {
    goals.push_back(LifecycleGoal{Lifecycle::kActive, {}});
    return goals;
  }
  if (is_left_to_group(adaptation.component, knowledge)) return goals;
  const auto* was = std::get_if<Lifecycle>(&sent.front()->command.purpose.before);
  if (was != nullptr && (*was == Lifecycle::kActive || *was == Lifecycle::kInactive))
    goals.push_back(bringing_up(adaptation, *was, knowledge));
  return goals;
}

std::vector<Goal> goals_of_lifecycle(const Sent& sent, AdaptationType type) {
  const auto target = [&] {
    const auto last = std::get<ChangeLifecycle>(sent.back()->command.what).transition;
    return last == Transition::kDeactivate ? Lifecycle::kInactive : Lifecycle::kActive;
  };
  std::vector<Goal> goals{LifecycleGoal{target(), {}}};
  if (type == AdaptationType::kRestart && target() == Lifecycle::kInactive)
    goals.push_back(LifecycleGoal{Lifecycle::kActive, {}});
  return goals;
}

}  // namespace

Resumption resumption_of(const Interrupted& interrupted, const Knowledge& knowledge) {
  Resumption resumption{interrupted.adaptations_done, {}, ""};
  const Sent sent = sent_for(interrupted);
  if (sent.empty()) return resumption;
  const auto& adaptations = knowledge.rules[interrupted.strategy].adaptations;
  const AdaptationType type = adaptations[interrupted.adaptations_done].type;
  const Interrupted::Request& last = *sent.back();
  if (last_of<StopProcess>(sent) != nullptr || last_of<StartProcess>(sent) != nullptr) {
    resumption.goals = goals_of_process(sent, adaptations[interrupted.adaptations_done], knowledge);
  } else if (std::holds_alternative<ChangeLifecycle>(last.command.what)) {
    resumption.goals = goals_of_lifecycle(sent, type);
  } else if (const auto* set = std::get_if<SetParameter>(&last.command.what)) {
    resumption.goals = {ParameterGoal{set->name, set->value, ParameterGoal::Kind::kRestore, {}}};
  } else if (const auto* change = std::get_if<ChangeMode>(&last.command.what)) {
    resumption.goals = {ModeGoal{change->mode}};
  } else if (last.outcome == Outcome::kDone) {
    ++resumption.adaptation;
  } else {
    resumption.obstacle = last.outcome
                              ? to_string(last.command) + " failed before culprit ended"
                              : "culprit ended while it asked to " + to_string(last.command) +
                                    "; it is unknown whether that was done";
  }
  return resumption;
}

std::vector<Undo> undo_of(const Interrupted& interrupted, const Knowledge& knowledge) {
  const auto& adaptations = knowledge.rules[interrupted.strategy].adaptations;
  std::vector<Undo> all;
  if (knowledge.rules[interrupted.strategy].is_last_resort) return all;  // it is to last
  for (const Interrupted::Request& request : interrupted.requests) {
    const Command& command = request.command;
    if (command.purpose.undoes) continue;
    const Adaptation& adaptation = adaptations[command.purpose.adaptation];
    if (adaptation.group) continue;
    if (std::holds_alternative<StopProcess>(command.what) &&
        is_undone_by_start(adaptation, knowledge.rules)) {
      const auto* was = std::get_if<Lifecycle>(&command.purpose.before);
      for (Goal& goal : starting_again(adaptation, was ? *was : Lifecycle::kUnknown, knowledge))
        all.push_back({command.component, std::move(goal)});
      continue;
    }
    std::optional<Goal> changed;
    if (const auto* set = std::get_if<SetParameter>(&command.what)) {
      changed = ParameterGoal{set->name, set->value, ParameterGoal::Kind::kSet, {}};
    } else if (const auto* change = std::get_if<ChangeMode>(&command.what)) {
      changed = ModeGoal{change->mode};
    } else if (std::holds_alternative<ChangeLifecycle>(command.what)) {
      changed = LifecycleGoal{};
    }
    if (!changed) continue;
    const Reply before{{}, Outcome::kDone, command.purpose.before, ""};
    if (auto goal = undoing(*changed, adaptation.type, before))
      all.push_back({command.component, std::move(*goal)});
  }
  return all;
}

}  // namespace culprit::execute
