#include "execute/goal.h"

#include <algorithm>
#include <cmath>

#include "base/ros_names.h"
#include "knowledge/held.h"
#include "language/evaluate.h"

namespace culprit::execute {
namespace {

using namespace std::chrono_literals;

template <class... F>
struct Overload : F... {
  using F::operator()...;
};
// clang before 17 does not deduce this by itself, and the fuzzers are built by it.
template <class... F>
Overload(F...) -> Overload<F...>;

Value negated(const Value& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value))
    return *whole == INT64_MIN ? INT64_MAX : -*whole;
  return -std::get<double>(value);
}

bool deactivates(const Rule& rule, ComponentId component, const RuleSet& rules) {
  return std::ranges::any_of(rule.strategies, [&](StrategyId id) {
    return std::ranges::any_of(rules[id].adaptations, [&](const Adaptation& a) {
      return a.component == component && a.type == AdaptationType::kDeactivate;
    });
  });
}

// The lifecycle state that rules demand of the component: a trigger that is true now would be true
// if it were inactive and not if it were active; or the other way round, and the rule deactivates
// it. Otherwise `lifecycle(c) == "active" && ...` only says when the rule looks. Empty if no rule
// demands one.
std::optional<Lifecycle> demanded(ComponentId component, const Knowledge& knowledge) {
  const RuleSet& rules = knowledge.rules;
  const auto fires = [&](const Rule& rule, std::string_view state) {
    std::vector<Slot> slots(knowledge.signals.slots().begin(), knowledge.signals.slots().end());
    for (const InputId id : rule.inputs) {
      const Input& input = rules[id];
      if (input.component != component) continue;
      if (input.kind == Input::Kind::kLifecycle) slots[id.index] = Slot::of(state);
      if (input.kind == Input::Kind::kAlive) slots[id.index] = Slot::of(true);
    }
    const Slot result = evaluate(rule.trigger, slots);
    return result.known && result.b;
  };
  for (const Rule& rule : rules.rules) {
    const bool reads = std::any_of(rule.inputs.begin(), rule.inputs.end(), [&](InputId id) {
      return rules[id].kind == Input::Kind::kLifecycle && rules[id].component == component;
    });
    if (!reads) continue;
    const bool if_active = fires(rule, to_string(Lifecycle::kActive));
    const bool if_inactive = fires(rule, to_string(Lifecycle::kInactive));
    if (if_inactive && !if_active) return Lifecycle::kActive;
    if (if_active && !if_inactive && deactivates(rule, component, rules))
      return Lifecycle::kInactive;
  }
  return std::nullopt;
}

PresentGoal present(const Adaptation& adaptation, const Knowledge& knowledge) {
  PresentGoal goal;
  const Duration joining = knowledge.components[adaptation.component].coming_up.joining;
  const Duration impact = duration_of(adaptation.impact, knowledge.rules);
  goal.patience = std::max<Duration>(
      {goal.patience, impact, std::min<Duration>(4 * joining, PresentGoal::kMost)});
  // The container that loads it answers when it has been made.
  if (knowledge.rules[adaptation.component].composed)
    goal.answer = std::max(goal.answer, goal.patience);
  goal.longest = joining > Duration::zero() ? goal.patience : std::max(goal.longest, goal.patience);
  return goal;
}

// An author who states a long impact may mean a routine that answers when it has done its work.
ServiceGoal calling(const Adaptation& adaptation, const Knowledge& knowledge) {
  ServiceGoal goal;
  goal.service = service_of(adaptation.subject, knowledge.graph.node_name(adaptation.component));
  goal.request = adaptation.request;
  goal.answer = std::max(goal.answer, duration_of(adaptation.impact, knowledge.rules));
  return goal;
}

// NaN cannot be set and read back.
bool is_nan(const Value& value) {
  const auto* number = std::get_if<double>(&value);
  return number != nullptr && std::isnan(*number);
}

}  // namespace

Duration patience(const Goal& goal) {
  return std::visit(
      Overload{[](const ParameterGoal&) -> Duration { return 3s; },
               [](const LifecycleGoal& g) -> Duration { return g.patience + g.grace; },
               [](const ModeGoal&) -> Duration { return 10s; },
               [](const ServiceGoal& g) -> Duration { return g.answer + 5s; },
               [](const GoneGoal&) -> Duration { return 15s; },
               [](const PresentGoal& g) -> Duration { return g.patience; }},
      goal);
}

// How long a node that was just started may leave what it is asked without an answer: twice as long as the
// last start took, kLeastLoading at least. A simulated robot (no `finding`) answers at once or never.
Duration loading_of(const ComingUp& before, const Knowledge& knowledge) {
  constexpr Duration kLeastLoading = 10s;
  constexpr Duration kMostLoading = 60s;
  if (knowledge.finding <= Duration::zero()) return {};
  return std::clamp<Duration>(2 * (before.joining + before.rising), kLeastLoading, kMostLoading);
}

constexpr Duration kLongestGrace = 60s;

Duration grace_of_driver(const Adaptation& adaptation, const Knowledge& knowledge) {
  const ComingUp& before = knowledge.components[adaptation.component].coming_up;
  if (before.driver != ComingUp::Driver::kOther) return {};
  return std::min<Duration>(2 * before.rising + duration_of(adaptation.impact, knowledge.rules),
                            kLongestGrace);
}

// Decides who brings it up. In this order: the rule file says so; somebody was seen to do it; culprit did it
// before. Where nothing is known, culprit watches first: two drivers of one node's lifecycle make each other
// fail. Another driver gets as long as the start took to show itself; at least until the impact is over, and
// at least twice the time of discovery. In a simulated robot no discovery is needed, so a rule that demands
// the state is reason enough to act at once.
LifecycleGoal bringing_up(const Adaptation& adaptation, Lifecycle target,
                          const Knowledge& knowledge) {
  using Driver = ComingUp::Driver;
  const ComingUp& before = knowledge.components[adaptation.component].coming_up;
  const Duration impact = duration_of(adaptation.impact, knowledge.rules);
  LifecycleGoal goal{target};
  goal.patience = longest_transition(before);
  goal.loading = loading_of(before, knowledge);
  if (before.rising <= Duration::zero()) goal.patience = std::max(goal.patience, impact);
  switch (knowledge.rules[adaptation.component].lifecycle) {
    case LifecycleDriver::kManaged:
      return goal;
    case LifecycleDriver::kSelf:
    case LifecycleDriver::kLauncher:
      goal.is_left_to_others = true;
      goal.patience = std::max<Duration>(goal.patience, 30s);
      return goal;
    case LifecycleDriver::kUndeclared:
      break;
  }
  if (before.driver == Driver::kOther) {
    goal.grace = grace_of_driver(adaptation, knowledge);
  } else if (before.driver == Driver::kUnknown &&
             (knowledge.finding > Duration::zero() || !demanded(adaptation.component, knowledge))) {
    goal.grace = std::min<Duration>(
        std::max({before.joining, impact - before.joining, 2 * knowledge.finding}), kLongestGrace);
  }
  goal.may_have_driver = knowledge.finding > Duration::zero() && before.driver != Driver::kCulprit;
  return goal;
}

// The manager of its group brings it up, or else start_group does: whoever waits here for that would keep it
// from start_group.
bool is_left_to_group(ComponentId component, const Knowledge& knowledge) {
  const LifecycleDriver driver = knowledge.rules[component].lifecycle;
  return (driver == LifecycleDriver::kLauncher || driver == LifecycleDriver::kUndeclared) &&
         std::ranges::any_of(knowledge.rules.groups, [&](const Group& group) {
           return std::ranges::find(group.members, component) != group.members.end();
         });
}

namespace {

// The process is ended, and another one is there.
std::vector<Goal> replacing(const Adaptation& adaptation, const Knowledge& knowledge) {
  const ComponentState& state = knowledge.components[adaptation.component];
  GoneGoal gone;
  PresentGoal back = present(adaptation, knowledge);
  // A process that took its place meanwhile is not ended. systemd may be faster than the news of the
  // end; and a container may be replaced for one of those that it loads.
  const Component& component = knowledge.rules[adaptation.component];
  if (component.has_owner() || component.composed || state.known_pid() != 0 ||
      is_container(adaptation.component, knowledge.rules)) {
    gone.pid = state.known_pid();
    back.instead_of = gone.pid;
    if (!component.host().empty()) back.instead_of_seen = state.node_seen;
  }
  return {gone, back};
}

// Without an answer for so long it is hung, also if other threads of its process work: after bond_timeout, 4 s,
// Nav2's manager takes it for dead. A simulated robot answers at once or never.
constexpr Duration kMemberHangs = 4s;

LifecycleGoal bringing_up_past_manager(const ComponentState& state, const Knowledge& knowledge) {
  LifecycleGoal up{Lifecycle::kActive, {}};
  up.patience = std::max(longest_transition({}), longest_transition(state.coming_up));
  up.loading = loading_of(state.coming_up, knowledge);
  return up;
}

// A member of a group is brought up past the manager, whoever does that when it starts.
Expected<std::vector<Goal>> bringing_up_member(const Adaptation& adaptation,
                                               const Knowledge& knowledge) {
  const ComponentState& state = knowledge.components[adaptation.component];
  const bool can_start_again = knowledge.rules[adaptation.component].can_start_again();
  std::vector<Goal> goals;
  LifecycleGoal up = bringing_up_past_manager(state, knowledge);
  if (state.alive == false) {
    if (!can_start_again) return Error{"it is not alive, and has no LAUNCH command"};
    goals = replacing(adaptation, knowledge);
  } else if (can_start_again) {
    up.hangs_after = knowledge.finding > Duration::zero() ? kMemberHangs : Duration::zero();
  }
  goals.emplace_back(up);
  return goals;
}

Expected<std::vector<Goal>> setting(const Adaptation& adaptation, const Knowledge& knowledge) {
  const Slot slot = evaluate(adaptation.value, knowledge.signals.slots());
  if (!slot.known) return Error{"the new value of " + adaptation.subject + " is unknown now"};
  const Value value = to_value(slot, adaptation.value.type);
  if (adaptation.type == AdaptationType::kSetParameter) {
    return std::vector<Goal>{ParameterGoal{adaptation.subject, value, ParameterGoal::Kind::kSet,
                                           knowledge.components[adaptation.parameter]}};
  }
  const bool up = adaptation.type == AdaptationType::kIncreaseParameter;
  return std::vector<Goal>{
      ParameterGoal{adaptation.subject, up ? value : negated(value), ParameterGoal::Kind::kAdd}};
}

// A last resort holds that it is not active.
bool is_kept_inactive(ComponentId component, const Knowledge& knowledge) {
  Adaptation activation;
  activation.component = component;
  activation.type = AdaptationType::kActivate;
  return holder_of(activation, knowledge).has_value();
}

// A managed node comes back unconfigured unless it brings itself up: it is brought to where it was, or to where a rule
// says that it must be.
std::vector<Goal> redeploying(const Adaptation& adaptation, const Knowledge& knowledge) {
  const ComponentState& state = knowledge.components[adaptation.component];
  std::vector<Goal> goals = replacing(adaptation, knowledge);
  if (state.intended_lifecycle == Lifecycle::kUnknown ||
      is_left_to_group(adaptation.component, knowledge))
    return goals;
  const Lifecycle target =
      is_kept_inactive(adaptation.component, knowledge)
          ? Lifecycle::kInactive
          : demanded(adaptation.component, knowledge).value_or(state.intended_lifecycle);
  if (target == Lifecycle::kActive || target == Lifecycle::kInactive)
    goals.push_back(bringing_up(adaptation, target, knowledge));
  return goals;
}

std::vector<Goal> starting(const Adaptation& adaptation, const Knowledge& knowledge) {
  const ComponentState& state = knowledge.components[adaptation.component];
  if (state.alive == true) return {};  // somebody else was there first
  std::vector<Goal> goals{present(adaptation, knowledge)};
  if (state.intended_lifecycle != Lifecycle::kUnknown &&
      !is_left_to_group(adaptation.component, knowledge))
    goals.push_back(bringing_up(adaptation,
                                is_kept_inactive(adaptation.component, knowledge)
                                    ? Lifecycle::kInactive
                                    : Lifecycle::kActive,
                                knowledge));
  return goals;
}

}  // namespace

std::vector<Goal> replacing_hung_member(const Adaptation& adaptation, const Knowledge& knowledge) {
  std::vector<Goal> goals = replacing(adaptation, knowledge);
  std::get<GoneGoal>(goals.front()).hangs = true;
  goals.emplace_back(
      bringing_up_past_manager(knowledge.components[adaptation.component], knowledge));
  return goals;
}

Expected<std::vector<Goal>> goals_of(const Adaptation& adaptation, const Knowledge& knowledge) {
  const ComponentState& state = knowledge.components[adaptation.component];
  const bool is_member = adaptation.group && adaptation.type == AdaptationType::kActivate;
  if (is_member) return bringing_up_member(adaptation, knowledge);
  switch (adaptation.type) {
    case AdaptationType::kSetParameter:
    case AdaptationType::kIncreaseParameter:
    case AdaptationType::kDecreaseParameter:
      return setting(adaptation, knowledge);
    case AdaptationType::kChangeCommunication:
      return std::vector<Goal>{ParameterGoal{adaptation.subject, adaptation.topic,
                                             ParameterGoal::Kind::kSet,
                                             knowledge.components[adaptation.parameter]}};
    case AdaptationType::kActivate:
      return std::vector<Goal>{LifecycleGoal{Lifecycle::kActive, {}}};
    case AdaptationType::kDeactivate:
      return std::vector<Goal>{LifecycleGoal{Lifecycle::kInactive, {}}};
    case AdaptationType::kRestart:
      return std::vector<Goal>{LifecycleGoal{Lifecycle::kInactive, {}},
                               LifecycleGoal{Lifecycle::kActive, {}}};
    case AdaptationType::kRedeploy:
      return redeploying(adaptation, knowledge);
    case AdaptationType::kStart:
      return starting(adaptation, knowledge);
    case AdaptationType::kStop:
      if (state.alive == false && state.known_pid() == 0) return std::vector<Goal>{};
      return std::vector<Goal>{GoneGoal{}};
    case AdaptationType::kChangeMode:
      return std::vector<Goal>{ModeGoal{adaptation.subject}};
    case AdaptationType::kStartGroup:  // a rule set holds its parts instead
      return std::vector<Goal>{};
    case AdaptationType::kCall:
      return std::vector<Goal>{calling(adaptation, knowledge)};
  }
  return std::vector<Goal>{};
}

bool is_undone_by_start(const Adaptation& adaptation, const RuleSet& rules) {
  return adaptation.type == AdaptationType::kStop && rules[adaptation.component].can_start();
}

std::vector<Goal> starting_again(const Adaptation& stop, Lifecycle before,
                                 const Knowledge& knowledge) {
  std::vector<Goal> goals;
  if (before == Lifecycle::kActive || before == Lifecycle::kInactive)
    goals.push_back(bringing_up(stop, before, knowledge));
  goals.push_back(present(stop, knowledge));
  return goals;
}

std::optional<Look> look_for(const Goal& goal) {
  if (const auto* parameter = std::get_if<ParameterGoal>(&goal))
    return ReadParameter{parameter->name};
  if (std::holds_alternative<LifecycleGoal>(goal)) return ReadLifecycle{};
  if (std::holds_alternative<ModeGoal>(goal)) return ReadMode{};
  return std::nullopt;
}

std::optional<Goal> undoing(const Goal& goal, AdaptationType type, const Reply& before) {
  // The value in a new process was undone before, and only now reaches it.
  if (type == AdaptationType::kRedeploy || type == AdaptationType::kStart) return std::nullopt;
  if (const auto* parameter = std::get_if<ParameterGoal>(&goal)) {
    const auto* value = std::get_if<Value>(&before.value);
    if (value == nullptr || is_nan(*value)) return std::nullopt;
    return ParameterGoal{parameter->name, *value, ParameterGoal::Kind::kRestore};
  }
  if (std::holds_alternative<ModeGoal>(goal)) {
    const auto* value = std::get_if<Value>(&before.value);
    const auto* mode = value != nullptr ? std::get_if<std::string>(value) : nullptr;
    const bool is_known = mode != nullptr && !mode->empty() && *mode != kUnknownMode;
    return is_known ? std::optional<Goal>(ModeGoal{*mode}) : std::nullopt;
  }
  // A restart ends where it began; there is nothing to go back to.
  const bool switches = type == AdaptationType::kActivate || type == AdaptationType::kDeactivate;
  const auto* state = std::get_if<Lifecycle>(&before.value);
  const bool was_settled =
      state != nullptr && (*state == Lifecycle::kActive || *state == Lifecycle::kInactive);
  if (std::holds_alternative<LifecycleGoal>(goal) && switches && was_settled)
    return LifecycleGoal{*state, {}};
  return std::nullopt;
}

bool are_of_one_thing(const Goal& a, const Goal& b) {
  if (a.index() != b.index()) return false;
  const auto* parameter = std::get_if<ParameterGoal>(&a);
  return parameter == nullptr || parameter->name == std::get<ParameterGoal>(b).name;
}

std::string describe(const Goal& goal) {
  return std::visit(
      Overload{[](const ParameterGoal& g) {
                 return g.name + (g.kind == ParameterGoal::Kind::kAdd ? " + " : " = ") +
                        culprit::to_string(g.value);
               },
               [](const LifecycleGoal& g) { return std::string(to_string(g.target)); },
               [](const ModeGoal& g) { return "mode " + g.mode; },
               [](const ServiceGoal& g) { return g.service; },
               [](const GoneGoal&) { return std::string("stopped"); },
               [](const PresentGoal&) { return std::string("running and in the graph"); }},
      goal);
}

}  // namespace culprit::execute
