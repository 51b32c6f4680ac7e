#include "torture/invariants.h"

#include <algorithm>
#include <cmath>

#include "language/evaluate.h"

namespace culprit::torture {
namespace {

// Requests and verdicts follow each other at one point of time; so many of them never do.
constexpr int kMostStepsAtOnce = 200;

// A component that was well for this long is known to be well, and so are those that need it.
constexpr Duration kKnownToBeWell = std::chrono::seconds(3);

bool is_seen_as_it_is(const Scenario& scenario) {
  const Noise& noise = scenario.noise;
  if (noise.loss > 0 || noise.lateness > Duration::zero()) return false;
  return std::none_of(scenario.mishaps.begin(), scenario.mishaps.end(), [](const Mishap& m) {
    return m.kind == Mishap::Kind::kStaleStamp || m.kind == Mishap::Kind::kJump;
  });
}

bool is_dead(const ComponentState& state) {
  return state.pid != 0 && state.process == ProcessState::kGone && state.alive == false;
}

bool replaces(const Strategy& strategy) {
  return std::any_of(strategy.adaptations.begin(), strategy.adaptations.end(),
                     [](const auto& a) { return a.type == AdaptationType::kRedeploy; });
}

}  // namespace

Invariants::Invariants(const RuleSet& rules, const Scenario& scenario)
    : rules_(rules),
      is_bayes_(!scenario.uses_paper_planner),
      is_seen_true_(is_seen_as_it_is(scenario)),
      left_dead_since_(rules.rules.size(), kNever),
      last_resort_(rules.rules.size(), kLongAgo),
      last_resort_missing_(rules.rules.size(), kNever),
      dead_since_(rules.components.size(), kNever),
      unknown_since_(rules.rules.size(), kNever),
      searches_(rules.rules.size()),
      healthy_(scenario.governor.limits.backoff.healthy),
      overall_{scenario.governor.limits.overall, {}},
      kinds_{Budget{scenario.governor.limits.per_kind, {}},
             Budget{scenario.governor.limits.per_kind, {}},
             Budget{scenario.governor.limits.per_kind, {}}},
      components_(rules.components.size(), Budget{scenario.governor.limits.per_component, {}}),
      restarts_(rules.components.size(), Budget{scenario.governor.limits.restarts, {}}) {
  for (std::size_t part = 0; part < scenario.parts.size(); ++part)
    needs_.push_back(all_needs(scenario, part));
}

void Invariants::begin(const Manager& manager) {
  std::fill(left_dead_since_.begin(), left_dead_since_.end(), kNever);
  std::fill(last_resort_missing_.begin(), last_resort_missing_.end(), kNever);
  std::fill(unknown_since_.begin(), unknown_since_.end(), kNever);
  beliefs_.clear();
  for (std::size_t s = 0; s < rules_.strategies.size(); ++s)
    beliefs_.push_back(manager.knowledge().beliefs[StrategyId(s)]);
}

void Invariants::fail(Time at, std::string what) {
  if (!violation_) violation_ = Violation{at, std::move(what)};
}

// A culprit that was killed says nothing of a silence that ended meanwhile.
bool Invariants::is_silenced(Silenceable what, Time at) const {
  const auto found = silenced_.find(what);
  return found != silenced_.end() && at < found->second;
}

void Invariants::check(const Manager& manager, Time now, std::span<const Command> commands,
                       const Truth& truth) {
  begun_now_.clear();
  for (const Event& event : manager.events()) {
    count_attempts(event);
    if (const auto* chosen = std::get_if<StrategyChosen>(&event.what)) {
      if (!chosen->dry_run) on(manager, *chosen, truth, event.at);
    } else if (const auto* accepted = std::get_if<OrderAccepted>(&event.what)) {
      const auto& what = accepted->order.what;
      if (std::holds_alternative<Pause>(what)) is_paused_ = true;
      if (std::holds_alternative<Resume>(what)) is_paused_ = false;
      if (const auto* run = std::get_if<RunStrategy>(&what)) ordered_.insert(run->strategy);
      if (const auto* silence = std::get_if<Silence>(&what))
        silenced_[silence->what] = silence->lasts ? later(event.at, *silence->lasts) : kNever;
      if (const auto* lift = std::get_if<LiftSilence>(&what)) silenced_.erase(lift->what);
    } else if (const auto* done = std::get_if<LastResortDone>(&event.what)) {
      last_resort_[rules_[done->strategy].rule.index] = event.at;
    } else if (const auto* failed = std::get_if<StrategyFailed>(&event.what)) {
      // It is begun again with back-off.
      const Strategy& strategy = rules_[failed->strategy];
      if (strategy.is_last_resort) last_resort_[strategy.rule.index] = event.at;
    } else if (const auto* ended = std::get_if<SilenceEnded>(&event.what)) {
      silenced_.erase(ended->what);
    }
  }
  note_the_dead(manager, now);
  check_commands(commands, truth, now);
  check_beliefs(manager, now);
  check_last_resorts(manager, now);
  if (is_bayes_ && manager.hears()) check_the_dead(manager, now);
  if (is_seen_true_) check_sight(manager, now);
  steps_at_last_ = now == last_ ? steps_at_last_ + 1 : 0;
  last_ = now;
  if (steps_at_last_ > kMostStepsAtOnce) fail(now, "the manager steps without end");
}

// After the robot could not be heard, rates and windows are unknown anew.
void Invariants::check_sight(const Manager& manager, Time now) {
  constexpr Duration kBlindAfter = std::chrono::minutes(1);
  const Knowledge& knowledge = manager.knowledge();
  const bool begins_anew =
      !manager.hears() || std::ranges::any_of(manager.events(), [](const Event& event) {
        return std::holds_alternative<SleepNoticed>(event.what) ||
               std::holds_alternative<JudgementResumed>(event.what);
      });
  for (std::size_t r = 0; r < unknown_since_.size(); ++r) {
    const RuleId id(r);
    const RuleState& state = knowledge.states[id];
    const bool is_known = state.detection.known_death || state.attempt ||
                          evaluate(rules_[id].trigger, knowledge.signals.slots()).known;
    if (begins_anew || is_known) {
      unknown_since_[r] = kNever;
      continue;
    }
    if (unknown_since_[r] != kNever && later(unknown_since_[r], kBlindAfter) <= now &&
        !knowledge.blind_since(id))
      fail(now, rules_[id].name + " has had no value for a minute and is not blind");
    unknown_since_[r] = std::min(unknown_since_[r], now);
  }
}

void Invariants::note_the_dead(const Manager& manager, Time now) {
  for (std::size_t c = 0; c < dead_since_.size(); ++c) {
    const bool is_now = is_dead(manager.knowledge().components[ComponentId(c)]);
    dead_since_[c] = is_now ? std::min(dead_since_[c], now) : kNever;
  }
}

// A failure that no strategy repairs costs at most its attempts, in an hour or in a day, even if the
// budgets of a minute allow more. The same holds for one that flaps.
void Invariants::count_attempts(const Event& event) {
  const auto count = [&](StrategyId strategy) {
    const RuleId rule = rules_[strategy].rule;
    if (ordered_.contains(strategy) || rules_[strategy].is_last_resort) return;
    if (started_the_gone_.contains(strategy)) return;  // that goes on for ever
    if (++searches_[rule.index].attempts > rules_[rule].policies.attempts)
      fail(event.at, rules_[rule].name + " is treated more often than its ATTEMPTS allow");
  };
  const auto is_gone = [&](RuleId rule) { searches_[rule.index].gone = event.at; };
  if (const auto* detected = std::get_if<FailureDetected>(&event.what)) {
    Search& search = searches_[detected->rule.index];
    if (search.gone && event.at - *search.gone >= healthy_) search.attempts = 0;
    search.gone.reset();
  } else if (const auto* failed = std::get_if<StrategyFailed>(&event.what)) {
    count(failed->strategy);
  } else if (const auto* resolved = std::get_if<FailureResolved>(&event.what)) {
    if (resolved->strategy) count(*resolved->strategy);
    is_gone(resolved->rule);
  } else if (const auto* lost = std::get_if<FailureLost>(&event.what)) {
    is_gone(lost->rule);
  }
}

void Invariants::on(const Manager& manager, const StrategyChosen& chosen, const Truth& truth,
                    Time at) {
  const Strategy& strategy = rules_[chosen.strategy];
  const std::string name = rules_[strategy.rule].name + "." + strategy.name;
  const bool starts_the_gone =
      replaces(strategy) && std::ranges::all_of(strategy.components, [&](ComponentId c) {
        return is_dead(manager.knowledge().components[c]);
      });
  started_the_gone_.erase(chosen.strategy);
  if (starts_the_gone) started_the_gone_.insert(chosen.strategy);
  if (strategy.is_last_resort) {
    last_resort_[strategy.rule.index] = at;
  } else {
    spend(overall_, "overall", at);
    spend(kinds_[static_cast<std::size_t>(execute::kind_of(strategy))], "of its kind", at);
  }
  for (const ComponentId component : strategy.components) {
    const std::string& where = rules_[component].name;
    if (!strategy.is_last_resort) spend(components_[component.index], "of " + where, at);
    if (is_silenced(component, at)) fail(at, name + " is begun at the muted " + where);
    int busy = 0;
    for (const RuleId id : manager.knowledge().states.active()) {
      const auto& attempt = manager.knowledge().states[id].attempt;
      if (!attempt || attempt->stage == Attempt::Stage::kSuspended) continue;
      const auto& adapted = rules_[attempt->strategy].components;
      if (std::binary_search(adapted.begin(), adapted.end(), component)) ++busy;
    }
    if (busy > 1) fail(at, where + " is adapted by several strategies at once");
  }
  for (const Adaptation& adaptation : strategy.adaptations) {
    const bool begins_anew = adaptation.type == AdaptationType::kRestart ||
                             adaptation.type == AdaptationType::kRedeploy ||
                             adaptation.type == AdaptationType::kStart;
    if (begins_anew && !starts_the_gone)
      spend(restarts_[adaptation.component.index],
            "of restarts of " + rules_[adaptation.component].name, at);
  }
  if (!strategy.is_last_resort && is_downstream_of_an_attempt(manager.knowledge(), strategy, at))
    fail(at, name + " is begun downstream of what is being adapted");
  begun_now_.insert(chosen.strategy);
  if (is_silenced(strategy.rule, at)) fail(at, name + " is begun though its rule is muted");
  check_replacement(manager, strategy, truth, at);
  for (const ComponentId component : strategy.components) {
    const ComponentState& state = manager.knowledge().components[component];
    if (state.in_graph && state.namesakes > 0 && !strategy.is_last_resort)
      fail(at, name + " is begun though another node has the name of " + rules_[component].name);
  }
  for (const ComponentId component : strategy.components) {
    if (is_seen_true_ && truth.is_leaving[component.index] && !strategy.is_last_resort)
      fail(at, name + " is begun though a person ends the launch of " + rules_[component].name);
  }
  if (!manager.hears()) fail(at, name + " is begun though culprit is deaf");
  if (is_paused_) fail(at, name + " is begun while paused");
  if (truth.is_moving && !strategy.is_last_resort)
    fail(at, name + " is begun though the robot moves");
}

bool Invariants::is_downstream_of_an_attempt(const Knowledge& knowledge, const Strategy& strategy,
                                             Time at) const {
  for (const RuleId id : knowledge.states.active()) {
    const auto& attempt = knowledge.states[id].attempt;
    if (!attempt || id == strategy.rule || ordered_.contains(attempt->strategy)) continue;
    const bool is_later = attempt->chosen == at && !begun_now_.contains(attempt->strategy);
    const bool is_lesser =
        rules_[id].policies.criticality < rules_[strategy.rule].policies.criticality;
    if (is_later) continue;
    // With bayes, what only waits for its verdict gives way to what is worse, by itself or by what
    // it explains.
    if (is_bayes_ ? attempt->effective != kNever : is_lesser) continue;
    const auto& adapted = rules_[attempt->strategy].components;
    for (const ComponentId component : strategy.components) {
      // The dead are replaced side by side.
      if (is_bayes_ && knowledge.components[component].process != ProcessState::kRunning) continue;
      for (const ComponentId upstream : knowledge.graph.upstream(component)) {
        if (std::binary_search(adapted.begin(), adapted.end(), upstream)) return true;
      }
    }
  }
  return false;
}

void Invariants::check_replacement(const Manager& manager, const Strategy& strategy,
                                   const Truth& truth, Time at) {
  if (!replaces(strategy) || strategy.is_last_resort) return;
  const std::string name = rules_[strategy.rule].name + "." + strategy.name;
  for (const ComponentId component : strategy.components) {
    const std::size_t part = component.index;
    const Time well = truth.well_since[part];
    if (is_seen_true_ && well != kNever && well + kKnownToBeWell <= at)
      fail(at, name + " is begun though " + rules_[component].name + " is well");
    const auto& components = manager.knowledge().components;
    // An exited or stopped process is replaced for it.
    if (!is_bayes_ || components[component].process != ProcessState::kRunning) continue;
    const Time failed = manager.knowledge().states[strategy.rule].first_detected();
    for (const std::size_t needed : needs_[part]) {
      const ComponentId cause(needed);
      // As far as can be observed: while it is inactive it needs no other, and where either may
      // need the other they take turns.
      const auto needs = [&](ComponentId consumer, ComponentId producer) {
        const auto& upstream = manager.knowledge().graph.upstream(consumer);
        return std::find(upstream.begin(), upstream.end(), producer) != upstream.end();
      };
      if (!needs(component, cause) || needs(cause, component)) continue;
      const bool is_explained =
          dead_since_[needed] <= failed && !fell_silent_before(manager, part, dead_since_[needed]);
      const char* why = is_explained ? " is dead"
                        : is_given_up(manager, cause, failed, truth.is_faulty[part])
                            ? " is silent and exhausted"
                            : nullptr;
      if (why != nullptr)
        fail(at, name + " is begun though " + rules_[cause].name + why + ", which explains it");
    }
  }
}

// The last message came so long before that time that the next one was missing by then: it has a cause of its own.
bool Invariants::fell_silent_before(const Manager& manager, std::size_t part, Time at) const {
  for (std::size_t t = 0; t < rules_.topics.size(); ++t) {
    if (rules_.topics[t].name != "/" + rules_.components[part].name) continue;
    const auto& rhythm = manager.knowledge().signals.rhythm(TopicId(t));
    if (rhythm.last && rhythm.gap > Duration::zero())
      return rhythm.silent_since() + rhythm.gap * 3 / 2 < at;
  }
  return false;
}

// Its silence began before `failed`, and nothing helped against it. An effect with a fault of its own
// may have outlasted a pause of that silence.
bool Invariants::is_given_up(const Manager& manager, ComponentId component, Time failed,
                             bool is_effect_faulty) const {
  const RuleStates& states = manager.knowledge().states;
  return std::any_of(states.exhausted().begin(), states.exhausted().end(), [&](RuleId rule) {
    const RuleState& silent = states[rule];
    const Time began = is_effect_faulty ? silent.failing_since : silent.first_detected();
    return states.awaits_person(rule) && rules_[rule].components.front() == component &&
           rules_[rule].name.starts_with("Silent") && began <= failed;
  });
}

void Invariants::check_last_resorts(const Manager& manager, Time now) {
  const Knowledge& knowledge = manager.knowledge();
  const auto is_held = [&](RuleId rule, ComponentId component) {
    return is_paused_ || !manager.hears() || is_silenced(rule, now) ||
           is_silenced(component, now) || knowledge.components[component].alive != true;
  };
  for (std::size_t s = 0; s < rules_.strategies.size(); ++s) {
    const Strategy& strategy = rules_.strategies[s];
    if (!strategy.is_last_resort) continue;
    const RuleState& state = knowledge.states[strategy.rule];
    const Slot& trigger = state.detection.trigger;
    const bool is_due = !state.last_resort && state.phase != RulePhase::kQuiet &&
                        (!trigger.known || trigger.b) &&
                        now >= later(state.failing_since, strategy.within) &&
                        last_resort_[strategy.rule.index] < state.failing_since;
    Time& missing = last_resort_missing_[strategy.rule.index];
    const bool is_missing = is_due && !is_held(strategy.rule, strategy.components.front());
    missing = is_missing ? std::min(missing, now) : kNever;
    if (is_missing && now - missing > 2 * rules_.cycle)
      fail(now, rules_[strategy.rule].name + "." + strategy.name + " is not begun WITHIN its time");
  }
}

// A decision comes at once, or, if the failure has to wait for anything, once in a cycle.
void Invariants::check_the_dead(const Manager& manager, Time now) {
  const Knowledge& knowledge = manager.knowledge();
  const bool is_held = manager.held_back().has_value();
  const std::vector<RuleId> plannable = manager.plannable();
  std::vector<Time> since(rules_.rules.size(), kNever);
  for (const RuleId id : plannable) {
    const ComponentId component = rules_[id].components.front();
    const auto& strategies = rules_[id].strategies;
    // A strategy that can only set a parameter must wait until the dead component is back.
    const bool can_replace = std::any_of(strategies.begin(), strategies.end(),
                                         [&](StrategyId s) { return replaces(rules_[s]); });
    // It was reported that it stays down.
    const bool is_let_be = knowledge.departures.stays_down(component);
    const bool is_left = can_replace && is_dead(knowledge.components[component]) && !is_held &&
                         !is_let_be && knowledge.states.reservation(component) == nullptr &&
                         std::none_of(strategies.begin(), strategies.end(),
                                      [&](StrategyId s) { return is_excused(manager, s); });
    if (!is_left) continue;
    since[id.index] = std::min(left_dead_since_[id.index], now);
    if (now - since[id.index] > 2 * rules_.cycle)
      fail(now, "nothing is done about " + rules_[id].name + " though " + rules_[component].name +
                    " is dead");
  }
  left_dead_since_ = std::move(since);
}

// The governor holds the strategy back, or a person is asked.
bool Invariants::is_excused(const Manager& manager, StrategyId strategy) const {
  const auto asked = manager.governor().asked();
  return !manager.knowledge().withheld[strategy.index].reason.empty() ||
         std::find(asked.begin(), asked.end(), strategy) != asked.end();
}

void Invariants::spend(Budget& budget, const std::string& what, Time at) {
  if (budget.limit.most == 0) return;
  budget.spent.push_back(at);
  const auto recent = std::count_if(budget.spent.begin(), budget.spent.end(),
                                    [&](Time t) { return at - t < budget.limit.period; });
  if (recent > budget.limit.most) fail(at, "the budget " + what + " is exceeded");
}

void Invariants::check_commands(std::span<const Command> commands, const Truth& truth, Time now) {
  for (const Command& command : commands) {
    const std::string& name = rules_[command.component].name;
    if (is_paused_ && !is_read(command))
      fail(now, name + ": " + to_string(command) + " is asked while paused");
    const bool is_there = truth.processes[command.component.index] != ProcessState::kGone;
    if (!std::holds_alternative<StartProcess>(command.what)) continue;
    const std::size_t part = command.component.index;
    if (is_there && !truth.is_launched[part])
      fail(now, name + " is started while its old process is there");
    if (!truth.was_there[part] && !ordered_.contains(command.purpose.strategy))
      fail(now, name + " is started though it was never there");
  }
}

void Invariants::check_beliefs(const Manager& manager, Time now) {
  for (std::size_t s = 0; s < beliefs_.size(); ++s) {
    const StrategyId id(s);
    const Belief belief = manager.knowledge().beliefs[id];
    if (belief == beliefs_[s]) continue;
    const double helped = belief.alpha - beliefs_[s].alpha;
    const double failed = belief.beta - beliefs_[s].beta;
    beliefs_[s] = belief;
    int successes = 0;
    int failures = 0;
    for (const Event& event : manager.events()) {
      const auto* counted = std::get_if<OutcomeCounted>(&event.what);
      if (counted == nullptr || counted->strategy != id) continue;
      successes += counted->as == OutcomeCounted::As::kSuccess ? 1 : 0;
      failures += counted->as == OutcomeCounted::As::kFailure ? 1 : 0;
    }
    const auto is_earned_by = [](double change, int outcomes) {
      constexpr double kRounding = 1e-9;
      return std::abs(change) < kRounding || std::abs(change - outcomes) < kRounding;
    };
    const bool is_earned = is_earned_by(helped, successes) && is_earned_by(failed, failures);
    if (!is_earned) fail(now, "the belief in " + rules_[id].name + " is no sum of outcomes");
  }
}

}  // namespace culprit::torture
