#include "manager/manager.h"

#include <algorithm>
#include <utility>

#include "base/invariant.h"
#include "diagnose/questions.h"
#include "manager/learned.h"
#include "plan/allowed.h"
#include "plan/also_ended.h"
#include "plan/awaits_valid_strategy.h"
#include "plan/beside_exhausted.h"
#include "plan/explained_by.h"
#include "plan/giving_back.h"

namespace culprit {
namespace {

// Did a person end one of them?
bool stays_any_down(std::span<const ComponentId> components, const Knowledge& knowledge) {
  return std::ranges::any_of(components, [&](ComponentId component) {
    return knowledge.departures.stays_down(component);
  });
}

// Does the governor withhold all strategies that were left to try until a person has looked?
bool is_given_up(const Decision& decision, const Knowledge& knowledge) {
  bool is_any = false;
  for (const Candidate& candidate : decision.candidates) {
    if (candidate.excluded == Condition::kTried || candidate.excluded == Condition::kInvalid)
      continue;
    const bool is_withheld = candidate.excluded == Condition::kWithheld;
    if (!is_withheld || !knowledge.withheld[candidate.strategy.index].is_given_up) return false;
    is_any = true;
  }
  return is_any;
}

// Samples and readings are many, and reach a plan only through the rules that they trigger; names
// do not reach it at all.
bool is_news(const Observation& observation) {
  return !std::holds_alternative<SampleArrived>(observation.what) &&
         !std::holds_alternative<SignalRead>(observation.what) &&
         !std::holds_alternative<DiagnosticRead>(observation.what) &&
         !std::holds_alternative<StatusHeard>(observation.what) &&
         !std::holds_alternative<ParametersListed>(observation.what);
}

bool tells_of_silence(const Observation& observation) {
  const auto* host = std::get_if<HostHeard>(&observation.what);
  const auto* reached = std::get_if<HostReached>(&observation.what);
  const auto* held = std::get_if<TimeHeld>(&observation.what);
  return (host != nullptr && !host->is_heard) || (reached != nullptr && !reached->is_reached) ||
         (held != nullptr && held->is_held);
}

}  // namespace

Manager::Manager(const RuleSet& rules, std::unique_ptr<const Planner> planner, Options options)
    : knowledge_(rules),
      monitor_(knowledge_,
               {knowledge_.signals, knowledge_.graph, knowledge_.components, knowledge_.departures,
                knowledge_.discovered, knowledge_.reported_names, knowledge_.clock_step,
                knowledge_.events},
               options.start, later(options.start, options.discovery)),
      analyzer_(knowledge_,
                {knowledge_.states, knowledge_.signals, knowledge_.beliefs, knowledge_.couplings,
                 knowledge_.latencies, knowledge_.coincidences, knowledge_.transients,
                 knowledge_.outcomes, knowledge_.blindness, knowledge_.events},
                options.start, later(options.start, options.discovery)),
      troubles_(knowledge_, knowledge_.components),
      planner_(std::move(planner)),
      executor_(knowledge_, {Attempts(knowledge_.states), knowledge_.components, knowledge_.signals,
                             knowledge_.outcomes, knowledge_.rivals, knowledge_.events}),
      governor_(knowledge_, {knowledge_.withheld, knowledge_.events}, options.governor,
                options.start),
      incidents_(std::move(options.incidents)),
      autonomy_(options.autonomy),
      discovered_(later(options.start, options.discovery)),
      now_(options.start),
      held_back_(rules.rules.size()) {
  if (options.governor.revives_in_doubt) knowledge_.departures.revive_in_doubt();
  knowledge_.beliefs.set_forgetting(options.forgetting);
  knowledge_.couplings.set_forgetting(options.forgetting);
  knowledge_.finding = options.governor.limits.quiet_downstream;
  knowledge_.outcomes.healthy = options.governor.limits.backoff.healthy;
}

Manager::~Manager() = default;

void Manager::remember(const History& past) {
  monitor_.remember(past);
  governor_.remember(past);
  analyzer_.remember(past);
}

void Manager::resume(Interrupted interrupted) {
  if (autonomy_ == Autonomy::kAdvise) return;
  const StrategyId strategy = interrupted.strategy;
  if (stays_any_down(knowledge_.rules[strategy].components, knowledge_)) return;
  executor_.resume(std::move(interrupted), now_, discovered_);
  governor_.began(strategy, now_);
}

std::vector<Command> Manager::step(Time now, std::span<const Observation> observations) {
  knowledge_.events.clear();
  take_in(now, observations);
  std::vector<Command> commands;
  if (!hears_) {
    next_plan_ = kNever;
  } else if (analyzer_.anything_to_do(now_) || may_give_back()) {
    react(commands);
  } else {
    executor_.advance(now_, commands);  // lets go of what has just succeeded
    troubles_.look(now_, false);
    next_plan_ = next_planning(now_);
  }
  if (hears_) analyzer_.look_for_blind(now_);
  governor_.note(knowledge_.events);
  follow_incidents();
  check(commands);
  return commands;
}

// A command that changes the robot against these would do harm.
void Manager::check(std::span<const Command> commands) const {
  CULPRIT_ASSERT(hears_ || commands.empty());
  for (const Command& command : commands) {
    CULPRIT_ASSERT(command.id != CommandId{});  // its answer would be no command's
    CULPRIT_ASSERT(command.component.index < knowledge_.rules.components.size());
    CULPRIT_ASSERT(is_read(command) || !governor_.is_paused());
    CULPRIT_ASSERT(command.timeout > Duration::zero());
    CULPRIT_ASSERT(command.purpose.strategy.index < knowledge_.rules.strategies.size());
    CULPRIT_ASSERT(command.purpose.adaptation <
                   knowledge_.rules[command.purpose.strategy].adaptations.size());
  }
}

void Manager::follow_incidents() {
  const bool is_due = std::exchange(is_incident_due_, false) && incidents_.is_any_open();
  if (!is_due && knowledge_.events.empty()) return;
  incidents_.advance(knowledge_, {governor_.is_paused(), governor_.asked()}, knowledge_.events);
}

void Manager::take_in(Time now, std::span<const Observation> observations) {
  for (const Observation& observation : observations) {
    // Late observations of an earlier time count for now: time does not go back.
    now_ = std::max(now_, std::min(observation.at, now));
    if (const auto* slept = std::get_if<Overslept>(&observation.what); slept && hears_) {
      oversleep(slept->by);
    } else if (const auto* lost = std::get_if<HearingLost>(&observation.what); lost && hears_) {
      hears_ = false;
      deaf_since_ = now_;
      executor_.forget_questions();
      knowledge_.events.tell(now_, JudgementSuspended{lost->reason});
    } else if (std::holds_alternative<HearingRegained>(observation.what) && !hears_) {
      hears_ = true;
      knowledge_.events.tell(now_, JudgementResumed{});
      restart(deaf_since_, now_);
    }
    monitor_.advance(now_);
    monitor_.observe(observation, now_);
    if (tells_of_silence(observation)) analyzer_.forgive_unheard(now_);
    if (const auto* reply = std::get_if<Reply>(&observation.what)) answered(*reply, now_);
    if (const auto* order = std::get_if<Order>(&observation.what)) obey(*order, now_);
    if (const auto* told = std::get_if<PriorsTold>(&observation.what))
      adopt_priors(*told, now_, knowledge_);
    const bool is_new = is_news(observation);
    news_ |= is_new;
    is_incident_due_ |= is_new;
    if (hears_) analyzer_.advance(now_);
  }
  now_ = std::max(now_, now);
  knowledge_.now = now_;
  monitor_.advance(now_);
  if (hears_) analyzer_.advance(now_);
  abandon_what_stays_down(now_);
  governor_.advance(now_);
  news_ |= !knowledge_.events.empty();
}

// An answer to the planner's question is evidence about the component as any other answer is.
void Manager::answered(const Reply& reply, Time now) {
  if (const auto component = executor_.proven_by(reply))
    monitor_.observe({now, Probed{*component, true}}, now);
  executor_.answered(reply, now);
}

void Manager::oversleep(Duration by) {
  if (by <= Overslept::kBriefly) return monitor_.stand_still(now_, later(now_, by));
  knowledge_.events.tell(now_, SleepNoticed{by});
  restart(now_ - by, now_);
}

// culprit did not listen from `since` until `now`, so that no gap, no delay and no late answer proves
// anything.
void Manager::restart(Time since, Time now) {
  monitor_.restart(since, now);
  analyzer_.restart(now);
  executor_.restart(now);
}

void Manager::react(std::vector<Command>& commands) {
  // Each stage can give the others something to do at once: a failed strategy makes room for the
  // next. A chain of more rounds than this goes on in the next step.
  constexpr int kRounds = 8;
  for (int round = 0; round < kRounds; ++round) {
    const std::size_t said = knowledge_.events.size();
    const std::size_t asked = commands.size();
    executor_.advance(now_, commands);
    analyzer_.advance(now_);
    if (news_ || now_ >= next_plan_) plan(now_, commands);
    begin_last_resorts(now_);
    executor_.advance(now_, commands);
    if (said == knowledge_.events.size() && asked == commands.size()) break;
    news_ = true;
  }
}

void Manager::obey(const Order& order, Time now) {
  const auto begun = governor_.begun_by(order);
  if (begun) refresh_conditions(*begun, now);
  if (!hears_ && begun)
    return knowledge_.events.tell(now,
                                  OrderRefused{order, "culprit receives nothing from the robot"});
  if (auto reason = governor_.objection(order, autonomy_))
    return knowledge_.events.tell(now, OrderRefused{order, std::move(*reason)});
  knowledge_.events.tell(now, OrderAccepted{order, governor_.last_resorts_behind(order)});
  governor_.obey(order, now);
  if (std::holds_alternative<Pause>(order.what)) {
    abandon_all("paused by " + order.author, now);
  } else if (const auto* dry_run = std::get_if<SetDryRun>(&order.what)) {
    autonomy_ = dry_run->is_on ? Autonomy::kAdvise : Autonomy::kAct;
    knowledge_.states.advise_anew();
  } else if (begun) {
    for (const ComponentId component : knowledge_.rules[*begun].components)
      knowledge_.departures.revive(component);
    if (knowledge_.rules[*begun].is_last_resort) go_before_others(*begun, now);
    begin(*begun, now);
  } else if (const auto* forgotten = std::get_if<Forget>(&order.what)) {
    forget_learned(forgotten->rule, knowledge_);
  } else if (std::holds_alternative<Revive>(order.what)) {
    knowledge_.departures.revive();
  } else if (std::holds_alternative<EndStarted>(order.what)) {
    knowledge_.departures.end_started();
  }
}

void Manager::abandon_all(const std::string& reason, Time now) {
  const std::vector<RuleId> active = knowledge_.states.active();
  for (const RuleId id : active) {
    const auto& attempt = knowledge_.states[id].attempt;
    if (!attempt) continue;
    knowledge_.events.tell(now, StrategyAbandoned{attempt->strategy, reason});
    analyzer_.abandon(id, now);
  }
  for (std::size_t r = 0; r < knowledge_.rules.rules.size(); ++r) {
    const auto& last_resort = knowledge_.states[RuleId(r)].last_resort;
    if (!last_resort) continue;
    knowledge_.events.tell(now, StrategyAbandoned{last_resort->strategy, reason});
    analyzer_.last_resorts().abandon(RuleId(r), now);
  }
}

// A strategy that had begun before starts no component again that a person ended.
void Manager::abandon_what_stays_down(Time now) {
  const bool is_any_new = std::ranges::any_of(knowledge_.events, [](const Event& event) {
    return std::holds_alternative<StaysDown>(event.what);
  });
  if (!is_any_new) return;
  const std::vector<RuleId> active = knowledge_.states.active();
  for (const RuleId id : active) {
    const auto& attempt = knowledge_.states[id].attempt;
    if (!attempt) continue;
    const auto& components = knowledge_.rules[attempt->strategy].components;
    const auto down = std::ranges::find_if(components, [&](ComponentId component) {
      return knowledge_.departures.stays_down(component);
    });
    if (down == components.end()) continue;
    knowledge_.events.tell(
        now, StrategyAbandoned{attempt->strategy, knowledge_.rules[*down].name + " stays down"});
    analyzer_.abandon(id, now);
  }
}

// An attempt that only waits for its verdict gives way to a more critical failure, and teaches
// nothing. It is judged afterwards, unless its change is undone.
void Manager::make_way_for(StrategyId strategy, Time now) {
  const RuleId rule = knowledge_.rules[strategy].rule;
  for (const ComponentId component : knowledge_.rules[strategy].components) {
    const Attempt* holder = knowledge_.states.reservation(component);
    if (holder == nullptr) continue;
    const StrategyId holding = holder->strategy;
    knowledge_.events.tell(
        now, StrategyAbandoned{holding, knowledge_.rules[component].name + " is needed for " +
                                            knowledge_.rules[rule].name});
    analyzer_.make_way(knowledge_.rules[holding].rule, strategy, now);
  }
}

void Manager::plan(Time now, std::vector<Command>& commands) {
  troubles_.look(now, !knowledge_.states.active().empty());
  const std::vector<RuleId> failures = analyzer_.plannable(now);
  for (const RuleId failure : failures) {
    for (const StrategyId strategy : knowledge_.rules[failure].strategies)
      refresh_conditions(strategy, now);
  }
  for (const Decision& decision : allowed_plan(failures, now)) {
    ask(decision, now, commands);
    if (decision.chosen) {
      // A strategy of this plan may have spent the last budget of its kind.
      const bool has_to_wait = governor_.holds_back({.strategy = *decision.chosen,
                                                     .candidates = decision.candidates,
                                                     .suspects = decision.suspects},
                                                    now) ||
                               governor_.withholds(*decision.chosen, now) ||
                               is_beside_last_resort(*decision.chosen);
      if (!has_to_wait) carry_out(decision, now);
      continue;
    }
    held_back_.held_back(decision, knowledge_.states[decision.rule].failing_since, now,
                         knowledge_.events);
    if (decision.is_spent && !plan::awaits_valid_strategy(decision, knowledge_)) {
      // While an unreachable computer explains the failure, attempts in vain are repeated once it is
      // reachable again.
      if (knowledge_.unheard_behind(decision.rule))
        analyzer_.last_resorts().turn_to(decision.rule, now);
      else if (!stays_any_down(knowledge_.rules[decision.rule].components, knowledge_))
        analyzer_.round_is_spent(decision.rule, now);
    } else if (is_given_up(decision, knowledge_)) {
      analyzer_.give_up(decision.rule, now);
    } else if (plan::waits_for_person(decision, knowledge_)) {
      analyzer_.last_resorts().turn_to(decision.rule, now);
    }
  }
  give_back(now);
  news_ = false;
  next_plan_ = next_planning(now);
}

bool Manager::may_give_back() const {
  return !knowledge_.components.owed().empty() && autonomy_ == Autonomy::kAct &&
         !governor_.is_paused();
}

// Activates what strategies have left inactive, if no failure asks for it any more. A culprit that has just begun
// does not know yet what is down.
void Manager::give_back(Time now) {
  if (!may_give_back() || now < discovered_) return;
  knowledge_.components.forget_given_back();
  for (const ComponentId component : knowledge_.components.owed()) {
    for (const RuleId rule : knowledge_.states.touching(component)) {
      for (const StrategyId each : knowledge_.rules[rule].strategies) refresh_conditions(each, now);
    }
    const auto strategy = plan::giving_back(component, knowledge_);
    if (strategy && !governor_.holds_back({.strategy = *strategy}, now) &&
        !governor_.withholds(*strategy, now))
      executor_.give_back(*strategy, component, now);
  }
}

void Manager::ask(const Decision& decision, Time now, std::vector<Command>& commands) {
  for (const ComponentId component : decision.asks) {
    // Another failure may ask it, too.
    if (knowledge_.components[component].questioned.at == now) continue;
    executor_.ask(component, decision.candidates.front().strategy, diagnose::kAnswersWithin, now,
                  commands);
  }
}

// Reads the conditions of the strategy anew: its WHEN and the interlocks.
void Manager::refresh_conditions(StrategyId strategy, Time now) {
  if (strategy.index < knowledge_.rules.strategies.size())
    monitor_.refresh(knowledge_.rules[strategy].when, now);
  for (const Interlock& interlock : knowledge_.rules.interlocks)
    monitor_.refresh(interlock.condition, now);
}

std::vector<Decision> Manager::allowed_plan(const std::vector<RuleId>& failures, Time now) {
  governor_.begin_planning();
  return plan::allowed(*planner_, failures, knowledge_,
                       [&](StrategyId chosen) { return governor_.withholds(chosen, now); });
}

// While a failure waits for its turn it is planned anew once per cycle, when its back-off ends, and when
// something is no longer withheld.
Time Manager::next_planning(Time now) const {
  Time next = analyzer_.next_start();
  const Time next_cycle = later(now, knowledge_.rules.cycle);
  if (next <= now) next = next_cycle;
  if (may_give_back()) next = std::min(next, next_cycle);
  for (const RuleId id : knowledge_.states.active()) {
    const RuleState& state = knowledge_.states[id];
    if (state.phase != RulePhase::kFailing || state.is_advised) continue;
    next = std::min(next, next_cycle);
    if (state.search.retry_at > now) next = std::min(next, state.search.retry_at);
    for (const StrategyId strategy : knowledge_.rules[id].strategies) {
      const Time allowed = knowledge_.withheld[strategy.index].until;
      if (allowed > now) next = std::min(next, allowed);
    }
  }
  return next;
}

void Manager::carry_out(const Decision& decision, Time now) {
  const StrategyId strategy = *decision.chosen;
  held_back_.went_on(decision.rule);
  const bool is_dry = autonomy_ == Autonomy::kAdvise;
  if (!is_dry && governor_.awaits_approval({strategy, decision.candidates, decision.suspects}, now))
    return;
  if (!is_dry) make_way_for(strategy, now);
  knowledge_.events.tell(
      now, StrategyChosen{strategy, decision.candidates, plan::explained_by(strategy, knowledge_),
                          is_dry, decision.suspects,
                          plan::also_ended(knowledge_.rules[strategy], knowledge_)});
  if (is_dry) {
    knowledge_.states.advise(decision.rule);
    return;
  }
  begin(strategy, now);
}

void Manager::begin(StrategyId strategy, Time now, std::vector<std::string> obstacles) {
  CULPRIT_ASSERT(autonomy_ == Autonomy::kAct);  // a dry run would change the robot
  for (const Adaptation& adaptation : knowledge_.rules[strategy].adaptations)
    monitor_.refresh(adaptation.value, now);
  executor_.begin(strategy, now, std::move(obstacles));
  governor_.began(strategy, now);
}

Incidents::Course Manager::course_of(const Incident& incident) const {
  const auto halt = !hears_                 ? Incidents::Halt::kDeaf
                    : governor_.is_paused() ? Incidents::Halt::kPaused
                                            : Incidents::Halt::kNone;
  return incidents_.course_of(incident, knowledge_, halt);
}

std::optional<std::string> Manager::held_back() const {
  const auto held = governor_.restraint_on_all(now_);
  return held ? std::optional(held->reason) : std::nullopt;
}

Time Manager::next_deadline() const {
  if (!hears_) return std::min(monitor_.next_deadline(), governor_.next_deadline());
  return std::min({monitor_.next_deadline(), analyzer_.next_deadline(), executor_.next_deadline(),
                   governor_.next_deadline(), next_plan_});
}

}  // namespace culprit
