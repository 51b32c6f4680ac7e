#include "execute/limits.h"

#include <algorithm>
#include <utility>

#include "diagnose/senders.h"

namespace culprit::execute {
namespace {

StrategyKind kind_of(AdaptationType type) {
  switch (type) {
    case AdaptationType::kRedeploy:
    case AdaptationType::kStart:
    case AdaptationType::kStop:
      return StrategyKind::kProcess;
    case AdaptationType::kActivate:
    case AdaptationType::kDeactivate:
    case AdaptationType::kRestart:
      return StrategyKind::kLifecycle;
    case AdaptationType::kSetParameter:
    case AdaptationType::kIncreaseParameter:
    case AdaptationType::kDecreaseParameter:
    case AdaptationType::kChangeCommunication:
    case AdaptationType::kChangeMode:
    case AdaptationType::kCall:
    case AdaptationType::kStartGroup:
      break;
  }
  return StrategyKind::kConfiguration;
}

bool restarts(const Adaptation& adaptation) {
  return adaptation.type == AdaptationType::kRestart ||
         kind_of(adaptation.type) == StrategyKind::kProcess;
}

// Not a stop, which may be the safe thing to do.
bool begins_anew(const Adaptation& adaptation) {
  return restarts(adaptation) && adaptation.type != AdaptationType::kStop;
}

// The noun for a number of strategies.
struct Words {
  std::string one;
  std::string many;
};

Words words(StrategyKind kind) {
  switch (kind) {
    case StrategyKind::kConfiguration:
      return {"reconfiguration", "reconfigurations"};
    case StrategyKind::kLifecycle:
      return {"lifecycle change", "lifecycle changes"};
    case StrategyKind::kProcess:
      return {"restart of a process", "restarts of processes"};
  }
  return {};
}

// Empty while one more is available.
std::optional<Limits::Limit> exceeded(const IntensityBudget& budget, Restraint restraint,
                                      const Words& what, Time now) {
  if (budget.available() <= now) return std::nullopt;
  const auto& [most, period] = budget.limit();
  return Limits::Limit{restraint,
                       std::to_string(most) + " " + (most == 1 ? what.one : what.many) + " in " +
                           to_string(period) + ", and no more are allowed",
                       budget.available()};
}

constexpr Duration kStartsOfTheGone = std::chrono::minutes(5);  // at most, beyond `restarts`

}  // namespace

StrategyKind kind_of(const Strategy& strategy) {
  StrategyKind kind = StrategyKind::kConfiguration;
  for (const Adaptation& adaptation : strategy.adaptations)
    kind = std::max(kind, kind_of(adaptation.type));
  return kind;
}

Limits::Limits(const Knowledge& knowledge, Options options)
    : knowledge_(knowledge),
      options_(options),
      overall_(options.overall),
      kinds_{IntensityBudget(options.per_kind), IntensityBudget(options.per_kind),
             IntensityBudget(options.per_kind)} {
  for (std::size_t c = 0; c < knowledge.rules.components.size(); ++c)
    components_.push_back(
        PerComponent{IntensityBudget(options.per_component), IntensityBudget(options.restarts)});
}

std::optional<Limits::Limit> Limits::on_all(Time now) const {
  return exceeded(overall_, Restraint::kOverallIntensity,
                  {"strategy was begun", "strategies were begun"}, now);
}

std::optional<Limits::Limit> Limits::on(StrategyId id, Time now) const {
  const Strategy& strategy = knowledge_.rules[id];
  const StrategyKind kind = kind_of(strategy);
  if (auto limit = exceeded(kinds_[static_cast<std::size_t>(kind)], Restraint::kClassIntensity,
                            words(kind), now))
    return limit;
  const bool only_starts = knowledge_.only_starts_the_gone(strategy);
  for (const ComponentId component : strategy.components) {
    const std::string& name = knowledge_.rules[component].name;
    if (auto limit =
            exceeded(components_[component.index].budget, Restraint::kComponentIntensity,
                     {"strategy was begun at " + name, "strategies were begun at " + name}, now))
      return limit;
    const bool is_paused_for_it = only_starts && knowledge_.components[component].alive != false;
    if (is_paused_for_it) continue;
    if (auto limit = quiet(component, now)) return limit;
  }
  for (const Adaptation& adaptation : strategy.adaptations) {
    if (!begins_anew(adaptation)) continue;
    if (auto limit = start(adaptation.component, strategy.rule, now)) return limit;
    const std::string& name = knowledge_.rules[adaptation.component].name;
    const PerComponent& state = components_[adaptation.component.index];
    auto limit = exceeded(state.begun_anew, Restraint::kRestarts,
                          {"restart of " + name, "restarts of " + name}, now);
    const bool was_told = knowledge_.states[strategy.rule].search.is_exhausted;
    if (limit && was_told && launches(adaptation) &&
        knowledge_.is_known_gone(adaptation.component)) {
      // A person was notified, and its start harms nothing: it is only delayed.
      limit->restraint = Restraint::kBackoff;
      limit->until = std::min(limit->until, later(state.restarted, kStartsOfTheGone));
      if (limit->until <= now) limit.reset();
    }
    if (limit) return limit;
  }
  for (const Adaptation& adaptation : strategy.adaptations) {
    if (!restarts(adaptation)) continue;
    if (auto limit = backoff(adaptation.component, strategy.rule, now)) return limit;
  }
  return std::nullopt;
}

bool Limits::was_healthy(ComponentId component, RuleId rule, Time failed) const {
  const PerComponent& state = components_[component.index];
  return state.well_since >= state.restarted &&
         later(state.well_since, options_.backoff.healthy) <= failed &&
         !knowledge_.states.is_sick(component, Criticality::kNonCritical, rule);
}

std::optional<Limits::Limit> Limits::backoff(ComponentId component, RuleId rule, Time now) const {
  const PerComponent& state = components_[component.index];
  if (options_.backoff.first == Duration::zero() || state.restarts == 0 ||
      was_healthy(component, rule, knowledge_.states[rule].failing_since))
    return std::nullopt;
  const int doublings = std::min(state.restarts - 1, 20);
  const Duration wait =
      std::min<Duration>(options_.backoff.first * (1 << doublings), options_.backoff.longest);
  const Time until = later(state.restarted, wait);
  if (until <= now) return std::nullopt;
  return Limit{Restraint::kBackoff,
               knowledge_.rules[component].name + " was restarted a short while ago", until};
}

std::optional<Limits::Limit> Limits::launched_within(Duration time, ComponentId component,
                                                     Time since, Time now) const {
  const Time until = later(since, time);
  if (since == kLongAgo || until <= now) return std::nullopt;
  return Limit{Restraint::kQuietPeriod,
               knowledge_.rules[component].name + " was launched a moment ago", until};
}

// Does the rule wait for a topic of the component that came before its process began, and not since? If it reads none:
// has nothing come at all?
bool Limits::is_silent_since_its_start(ComponentId component, RuleId rule) const {
  const Time begun = knowledge_.components[component].node_seen;
  bool reads_any = false;
  for (const InputId id : knowledge_.rules[rule].inputs) {
    const Input& input = knowledge_.rules[id];
    if (!diagnose::watches_a_topic(input) || diagnose::sender_of(input, knowledge_) != component)
      continue;
    reads_any = true;
    const auto& last = knowledge_.signals.rhythm(input.topic).last;
    if (last && *last < begun) return true;
  }
  const Time last = diagnose::sent_last(component, knowledge_);
  return !reads_any && last != kLongAgo && last < begun;
}

// A component that is being started is not begun anew within its READY.
std::optional<Limits::Limit> Limits::start(ComponentId component, RuleId rule, Time now) const {
  const Duration ready = knowledge_.rules[component].ready;
  if (ready == Duration::zero() || knowledge_.components[component].alive == false ||
      !is_silent_since_its_start(component, rule))
    return std::nullopt;
  return launched_within(ready, component, components_[component.index].launched, now);
}

std::optional<Limits::Limit> Limits::quiet(ComponentId component, Time now) const {
  // A component that is known to be down need not wait.
  const bool is_dead = knowledge_.components[component].alive == false;
  const bool finds_others = !is_dead && knowledge_.graph.reads_others(component);
  const Duration own_quiet = finds_others
                                 ? std::max(options_.quiet_after_launch, options_.quiet_downstream)
                                 : options_.quiet_after_launch;
  const Time launched = components_[component.index].launched;
  if (auto own = launched_within(own_quiet, component, launched, now)) return own;
  if (is_dead) return std::nullopt;
  for (const ComponentId upstream : knowledge_.graph.upstream(component)) {
    // For those that it feeds, it is back when what it publishes is there.
    const ComponentState& state = knowledge_.components[upstream];
    const Time came = components_[upstream.index].came;
    if (came == kLongAgo) continue;
    const Time since = std::max({came, state.ends_back, state.awaits_ends_until});
    if (auto of_upstream = launched_within(options_.quiet_downstream, upstream, since, now))
      return of_upstream;
  }
  return std::nullopt;
}

void Limits::began(StrategyId id, Time now) {
  spend(id, now, knowledge_.states[knowledge_.rules[id].rule].failing_since);
}

void Limits::remember(const History& past) {
  std::vector<Time> detected(knowledge_.rules.rules.size(), kLongAgo);
  for (const Event& event : past) {
    const auto spent = [&](StrategyId id) {
      if (knowledge_.rules[id].is_last_resort) return;
      spend(id, event.at, detected[knowledge_.rules[id].rule.index]);
    };
    if (const auto* failure = std::get_if<FailureDetected>(&event.what)) {
      detected[failure->rule.index] = event.at;
    } else if (const auto* chosen = std::get_if<StrategyChosen>(&event.what)) {
      spent(chosen->strategy);
    } else if (const auto* resumed = std::get_if<StrategyResumed>(&event.what)) {
      spent(resumed->strategy);
    } else if (const auto* accepted = std::get_if<OrderAccepted>(&event.what)) {
      const auto* run = std::get_if<RunStrategy>(&accepted->order.what);
      if (run != nullptr) spent(run->strategy);
    } else {
      note(event);
    }
  }
}

void Limits::spend(StrategyId id, Time now, Time failed) {
  const Strategy& strategy = knowledge_.rules[id];
  overall_.spend(now);
  kinds_[static_cast<std::size_t>(kind_of(strategy))].spend(now);
  for (const ComponentId component : strategy.components)
    components_[component.index].budget.spend(now);
  for (const Adaptation& adaptation : strategy.adaptations) {
    if (!restarts(adaptation)) continue;
    PerComponent& state = components_[adaptation.component.index];
    if (begins_anew(adaptation)) state.begun_anew.spend(now);
    if (was_healthy(adaptation.component, strategy.rule, failed)) state.restarts = 0;
    ++state.restarts;
    state.restarted = now;
  }
}

// It could not start a component, since something is missing: nothing was restarted, and once that is
// there nothing delays the start.
void Limits::give_back(StrategyId id) {
  for (const Adaptation& adaptation : knowledge_.rules[id].adaptations) {
    const bool is_barred =
        launches(adaptation) && !knowledge_.components[adaptation.component].start_missing.empty();
    if (!is_barred) continue;
    PerComponent& state = components_[adaptation.component.index];
    state.begun_anew.give_back();
    state.restarts = std::max(0, state.restarts - 1);
    state.restarted = kLongAgo;
  }
}

void Limits::note(const Event& event) {
  const auto is_well = [&](RuleId rule) {
    for (const ComponentId component : knowledge_.rules[rule].components)
      components_[component.index].well_since = event.at;
  };
  if (const auto* resolved = std::get_if<FailureResolved>(&event.what)) {
    is_well(resolved->rule);
  } else if (const auto* lost = std::get_if<FailureLost>(&event.what)) {
    is_well(lost->rule);
  } else if (const auto* done = std::get_if<AdaptationDone>(&event.what)) {
    const Adaptation& adaptation = knowledge_.rules[done->strategy].adaptations[done->adaptation];
    PerComponent& state = components_[adaptation.component.index];
    if (launches(adaptation)) state.launched = state.came = event.at;
  } else if (const auto* abandoned = std::get_if<StrategyAbandoned>(&event.what)) {
    give_back(abandoned->strategy);
  } else if (const auto* gone = std::get_if<ComponentLost>(&event.what)) {
    components_[gone->component.index].is_lost = true;
  } else if (const auto* back = std::get_if<ComponentFound>(&event.what)) {
    PerComponent& state = components_[back->component.index];
    if (std::exchange(state.is_lost, false)) state.came = event.at;
  }
}

}  // namespace culprit::execute
