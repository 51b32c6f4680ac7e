#include "execute/governor.h"

#include <algorithm>

#include "base/invariant.h"
#include "execute/evidence.h"
#include "knowledge/awaited_container.h"
#include "knowledge/describe.h"
#include "knowledge/old_value.h"

namespace culprit {
namespace {

template <class... F>
struct Overload : F... {
  using F::operator()...;
};
// clang before 17 does not deduce this by itself.
template <class... F>
Overload(F...) -> Overload<F...>;

bool touches(const Strategy& strategy, const Silenceable& what) {
  if (const auto* rule = std::get_if<RuleId>(&what)) return strategy.rule == *rule;
  return std::binary_search(strategy.components.begin(), strategy.components.end(),
                            std::get<ComponentId>(what));
}

bool exists(const Silenceable& what, const RuleSet& rules) {
  if (const auto* rule = std::get_if<RuleId>(&what)) return rule->index < rules.rules.size();
  return std::get<ComponentId>(what).index < rules.components.size();
}

Governor::Held paused() {
  return {Restraint::kPaused, "paused by a person; culprit resume lets it go on", kNever};
}

// When all values that the condition reads are what the robot says now.
Time confirmed_by(const Program& condition, const SignalStore& signals) {
  Time by = kLongAgo;
  for (const Instruction& each : condition.code) {
    if (each.op == Op::kInput) by = std::max(by, signals.confirmed_by(InputId(each.operand)));
  }
  return by;
}

Governor::Held is_back(const std::string& component, Time until) {
  return {Restraint::kLaunchEnded, component + " was started again a moment ago, not by culprit",
          until};
}

Governor::Held in_words(const Departures::Departure& departure, const std::string& component) {
  using What = Departures::What;
  const std::string launcher = "process " + std::to_string(departure.launcher);
  switch (departure.what) {
    case What::kIsEnding:
      if (departure.launcher == 0)
        return {Restraint::kLeaving,
                component + " exited cleanly; culprit asks its owner whether that was ordered",
                departure.until};
      return {Restraint::kLeaving,
              "the launch of " + launcher + " is being ended, " + component + " with it",
              departure.until};
    case What::kStaysDown:
      return {
          Restraint::kLaunchEnded,
          describe(departure, component) + "; start it again, or let culprit do it: culprit revive",
          departure.until};
    case What::kIsBack:
      break;
  }
  return is_back(component, departure.until);
}

// The one that ends last: a check that takes a moment, again and again, does not take turns with what holds all along.
std::optional<Governor::Held> longer(std::optional<Governor::Held> a,
                                     std::optional<Governor::Held> b) {
  return !a || (b && b->until > a->until) ? b : a;
}

}  // namespace

Governor::Options Governor::Options::recommended() {
  using namespace std::chrono_literals;
  Options options;
  options.quiet_at_start = 2s;
  options.limits.overall = {20, 60s};
  options.limits.per_kind = {12, 60s};
  options.limits.per_component = {6, 60s};
  options.limits.restarts = {20, 1h};
  options.limits.backoff = {1s, 60s, 60s};
  options.limits.quiet_after_launch = 1s;
  // Fast DDS announces a participant every 3 s; who missed the first announcements waits for the next.
  options.limits.quiet_downstream = 3500ms;
  options.storm.share = 0.6;
  options.needs_evidence = true;
  return options;
}

Governor::Governor(const Knowledge& knowledge, Writes writes, Options options, Time start)
    : knowledge_(knowledge),
      write_(writes),
      options_(options),
      start_(start),
      limits_(knowledge, options.limits),
      storm_(knowledge, writes.events, options.storm),
      refused_(knowledge.rules.strategies.size(), kNever),
      told_(knowledge.rules.strategies.size()) {}

void Governor::remember(const History& past) {
  limits_.remember(past);
  for (const Event& event : past) {
    const auto* accepted = std::get_if<OrderAccepted>(&event.what);
    const bool is_silence =
        accepted != nullptr && (std::holds_alternative<Silence>(accepted->order.what) ||
                                std::holds_alternative<LiftSilence>(accepted->order.what));
    if (is_silence) obey(accepted->order, event.at);
  }
}

// ---- orders

std::optional<std::string> Governor::objection(const Order& order, Autonomy autonomy) const {
  using Objection = std::optional<std::string>;
  const RuleSet& rules = knowledge_.rules;
  const auto about_question = [&](StrategyId strategy) -> Objection {
    if (strategy.index >= rules.strategies.size()) return "there is no such strategy";
    if (question_of(strategy) == nullptr)
      return rules[strategy].name + " does not wait for approval";
    return std::nullopt;
  };
  return std::visit(
      Overload{[&](const Pause&) -> Objection {
                 return is_paused_ ? Objection("it is paused already") : std::nullopt;
               },
               [&](const Resume&) -> Objection {
                 return is_paused_ ? std::nullopt : Objection("it is not paused");
               },
               [&](const SetDryRun& o) -> Objection {
                 if (o.is_on != (autonomy == Autonomy::kAdvise)) return std::nullopt;
                 return o.is_on ? "the dry run is on already" : "the dry run is off already";
               },
               [&](const Approve& o) {
                 const Objection none = about_question(o.strategy);
                 if (none || !question_of(o.strategy)->is_proposed) return none;
                 return objection_to_run(o.strategy, autonomy);
               },
               [&](const Refuse& o) { return about_question(o.strategy); },
               [&](const Propose& o) { return objection_to_propose(o.strategy); },
               [&](const Silence& o) -> Objection {
                 if (!exists(o.what, rules)) return "there is no such component or rule";
                 if (o.lasts && *o.lasts <= Duration::zero()) return "a mute lasts longer than 0 s";
                 return std::nullopt;
               },
               [&](const LiftSilence& o) -> Objection {
                 const bool is_there =
                     std::any_of(silences_.begin(), silences_.end(),
                                 [&](const ActiveSilence& s) { return s.what == o.what; });
                 return is_there ? std::nullopt : Objection("it is not muted");
               },
               [&](const RunStrategy& o) { return objection_to_run(o.strategy, autonomy); },
               [&](const Revive&) -> Objection {
                 return stays_anything_down() ? std::nullopt : Objection("nothing stays down");
               },
               [&](const EndStarted&) -> Objection {
                 if (autonomy == Autonomy::kAdvise) return "culprit only advises, and ends nothing";
                 if (is_paused_) return "culprit is paused, and ends nothing; resume it first";
                 return knowledge_.departures.started().empty()
                            ? Objection("nothing runs that culprit started")
                            : std::nullopt;
               },
               [&](const Forget& o) -> Objection {
                 if (o.rule && o.rule->index >= rules.rules.size()) return "there is no such rule";
                 return std::nullopt;
               }},
      order.what);
}

std::optional<std::string> Governor::objection_to_propose(StrategyId id) const {
  const RuleSet& rules = knowledge_.rules;
  if (id.index >= rules.strategies.size()) return "there is no such strategy";
  if (options_.approval == Approval::kNone)
    return "culprit asks for no approval; start it with run --approve";
  const Rule& rule = rules[rules[id].rule];
  const RuleState& state = knowledge_.states[rules[id].rule];
  if (state.phase != RulePhase::kFailing && state.phase != RulePhase::kExhausted)
    return rule.name + " needs no strategy now";
  if (question_of(id) != nullptr) return rules[id].name + " waits for approval already";
  if (refused_[id.index] == state.failing_since)
    return "a person refused " + rules[id].name + " for this failure";
  return std::nullopt;
}

std::optional<StrategyId> Governor::begun_by(const Order& order) const {
  if (const auto* run = std::get_if<RunStrategy>(&order.what)) return run->strategy;
  const auto* approved = std::get_if<Approve>(&order.what);
  const Question* question = approved == nullptr ? nullptr : question_of(approved->strategy);
  return question != nullptr && question->is_proposed ? std::optional(question->strategy)
                                                      : std::nullopt;
}

// A person's word goes before the limits, not before what keeps the robot safe.
std::optional<std::string> Governor::objection_to_run(StrategyId id, Autonomy autonomy) const {
  const RuleSet& rules = knowledge_.rules;
  if (id.index >= rules.strategies.size()) return "there is no such strategy";
  if (is_paused_) return "it is paused; resume first";
  if (autonomy == Autonomy::kAdvise) return "this is a dry run; switch it off first";
  const Strategy& strategy = rules[id];
  const auto& state = knowledge_.states[strategy.rule];
  if (strategy.is_last_resort ? state.last_resort : state.attempt)
    return "another strategy of " + rules[strategy.rule].name + " is under way";
  if (strategy.is_last_resort) return objection_to_last_resort(strategy);
  for (const ComponentId component : strategy.components) {
    if (knowledge_.states.reservation(component) != nullptr)
      return rules[component].name + " is being adapted";
  }
  if (const auto held = interlock()) return held->reason;
  if (auto doubt = execute::doubt_of_identity(strategy, knowledge_)) return doubt;
  return objection_by_when(strategy);
}

// It goes beside what is under way, and an interlock does not hold it.
std::optional<std::string> Governor::objection_to_last_resort(const Strategy& strategy) const {
  const bool is_of_process = execute::kind_of(strategy) == execute::StrategyKind::kProcess;
  if (auto doubt = is_of_process ? execute::doubt_of_identity(strategy, knowledge_) : std::nullopt)
    return doubt;
  return objection_by_when(strategy);
}

std::optional<std::string> Governor::objection_by_when(const Strategy& strategy) const {
  if (strategy.when.empty()) return std::nullopt;
  const Slot when = evaluate_when(strategy, knowledge_);
  return when.known && when.b ? std::nullopt
                              : std::optional<std::string>("its WHEN condition is not true");
}

void Governor::obey(const Order& order, Time now) {
  std::visit(
      Overload{[&](const Pause&) { is_paused_ = true; }, [&](const Resume&) { is_paused_ = false; },
               [&](const Approve& o) {
                 Question* const question = question_of(o.strategy);
                 CULPRIT_ASSERT(question != nullptr);
                 question->is_approved = true;
               },
               [&](const Refuse& o) {
                 CULPRIT_ASSERT(question_of(o.strategy) != nullptr);
                 const Question& question = *question_of(o.strategy);
                 refused_[o.strategy.index] = question.failing_since;
                 questions_.erase(questions_.begin() + (&question - questions_.data()));
               },
               [&](const Propose& o) {
                 CULPRIT_ASSERT(question_of(o.strategy) == nullptr);  // one approval for two
                 const Time since =
                     knowledge_.states[knowledge_.rules[o.strategy].rule].failing_since;
                 questions_.push_back({o.strategy, since, false, true});
                 write_.events.tell(now, ApprovalAsked{o.strategy, {}, {}});
               },
               [&](const Silence& o) {
                 std::erase_if(silences_, [&](const ActiveSilence& s) { return s.what == o.what; });
                 silences_.push_back(
                     {o.what, o.lasts ? later(now, *o.lasts) : kNever, order.author, order.reason});
               },
               [&](const LiftSilence& o) {
                 std::erase_if(silences_, [&](const ActiveSilence& s) { return s.what == o.what; });
               },
               // The manager's.
               [](const SetDryRun&) {}, [](const RunStrategy&) {}, [](const Forget&) {},
               [](const Revive&) {}, [](const EndStarted&) {}},
      order.what);
}

std::vector<StrategyId> Governor::asked() const {
  std::vector<StrategyId> strategies;
  for (const Question& question : questions_) {
    if (!question.is_approved) strategies.push_back(question.strategy);
  }
  return strategies;
}

const Governor::Question* Governor::question_of(StrategyId strategy) const {
  const auto found =
      std::find_if(questions_.begin(), questions_.end(),
                   [&](const Question& question) { return question.strategy == strategy; });
  return found == questions_.end() ? nullptr : &*found;
}

Governor::Question* Governor::question_of(StrategyId strategy) {
  return const_cast<Question*>(std::as_const(*this).question_of(strategy));
}

// ---- plans

void Governor::begin_planning() {
  for (const StrategyId strategy : withheld_) write_.withheld[strategy.index] = {};
  withheld_.clear();
}

bool Governor::withholds(StrategyId strategy, Time now) {
  const auto held = restraint_on(strategy, now);
  if (!held) return false;
  write_.withheld[strategy.index] = {
      held->reason, held->until, held->restraint == Restraint::kRestarts,
      held->restraint == Restraint::kEvidence && held->until == kNever};
  withheld_.push_back(strategy);
  tell({strategy}, *longer(held, restraint_on_all(now)), now);
  return true;
}

bool Governor::holds_back(ActionHeldBack chosen, Time now) {
  const auto held = restraint_on_all(now);
  if (held) tell(std::move(chosen), *held, now);
  return held.has_value();
}

std::optional<Governor::Held> Governor::restraint_on_all(Time now) const {
  if (is_paused_) return paused();
  if (storm_.storm())
    return Held{storm_.storm()->restraint, storm_.storm()->reason, storm_.next_deadline()};
  if (auto held = interlock()) return held;
  const Time quiet_until = later(start_, options_.quiet_at_start);
  if (now < quiet_until)
    return Held{Restraint::kQuietPeriod, "culprit started a moment ago", quiet_until};
  return limits_.on_all(now);
}

std::optional<Governor::Held> Governor::doubt_of_storm(RuleId failure) const {
  const auto& doubt = storm_.doubt();
  if (!doubt || std::ranges::find(doubt->failures, failure) == doubt->failures.end())
    return std::nullopt;
  return Held{Restraint::kStorm, doubt->reason, storm_.next_deadline()};
}

std::optional<Governor::Held> Governor::restraint_on(StrategyId id, Time now) const {
  if (auto held = restraint_by_person(id)) return held;
  if (auto doubt = execute::doubt_of_identity(knowledge_.rules[id], knowledge_))
    return Held{Restraint::kIdentity, std::move(*doubt), kNever};
  if (auto reason = execute::launch_of_the_unseen(knowledge_.rules[id], knowledge_))
    return Held{Restraint::kNeverSeen, std::move(*reason), kNever};
  if (auto held = doubt_of_storm(knowledge_.rules[id].rule)) return held;
  if (auto held = departure(knowledge_.rules[id], now)) return held;
  if (auto held = container_to_come(knowledge_.rules[id])) return held;
  if (auto driver = execute::driver_to_come(knowledge_.rules[id], knowledge_, now))
    return Held{Restraint::kEvidence, std::move(driver->reason), driver->until};
  return longer(lack_of_evidence(knowledge_.rules[id], now), limits_.on(id, now));
}

bool Governor::holds_last_resort_back(StrategyId strategy, std::optional<std::string> obstacle,
                                      Time now) {
  auto held = restraint_on_last_resort(strategy, now);
  if (!held && obstacle) held = Held{Restraint::kImpossible, std::move(*obstacle), kNever};
  if (held) tell({strategy}, *held, now);
  return held.has_value();
}

// A person's word, and whom it would hit if it ends or starts a process: no limit of any kind.
std::optional<Governor::Held> Governor::restraint_on_last_resort(StrategyId id, Time now) const {
  if (is_paused_) return paused();
  if (auto held = restraint_by_person(id)) return held;
  const Strategy& strategy = knowledge_.rules[id];
  if (execute::kind_of(strategy) != execute::StrategyKind::kProcess) return std::nullopt;
  if (auto doubt = execute::doubt_of_identity(strategy, knowledge_))
    return Held{Restraint::kIdentity, std::move(*doubt), kNever};
  if (auto reason = execute::launch_of_the_unseen(strategy, knowledge_))
    return Held{Restraint::kNeverSeen, std::move(*reason), kNever};
  const auto may_launch = [](const Adaptation& a) { return launches(a) || a.group; };
  return std::ranges::any_of(strategy.adaptations, may_launch) ? departure(strategy, now)
                                                               : std::nullopt;
}

std::vector<StrategyId> Governor::last_resorts_behind(const Order& order) const {
  const auto* silence = std::get_if<Silence>(&order.what);
  std::vector<StrategyId> held;
  for (std::size_t s = 0; s < knowledge_.rules.strategies.size(); ++s) {
    const Strategy& strategy = knowledge_.rules.strategies[s];
    const bool is_behind = std::holds_alternative<Pause>(order.what) ||
                           (silence != nullptr && touches(strategy, silence->what));
    if (strategy.is_last_resort && is_behind) held.emplace_back(s);
  }
  return held;
}

std::optional<Governor::Held> Governor::departure(const Strategy& strategy, Time now) const {
  for (const ComponentId component : strategy.components) {
    const auto home = container_of(component, knowledge_.rules);  // it would be started, too
    for (const ComponentId each : {component, home.value_or(component)}) {
      const auto departure = knowledge_.departures.of(each, now);
      if (departure) return in_words(*departure, knowledge_.rules[each].name);
    }
    const Time until = comes_up_by(component);
    if (now < until) return is_back(knowledge_.rules[component].name, until);
  }
  return std::nullopt;
}

// When a process that somebody else started again will have shown what its node does.
Time Governor::comes_up_by(ComponentId component) const {
  const ComponentState& state = knowledge_.components[component];
  const Time returned = knowledge_.departures.returned(component);
  if (returned == kLongAgo) return kLongAgo;
  const Time latest = later(returned, Departures::kBack);
  return state.is_coming_up() ? latest
                              : std::min(latest, later(state.node_seen, Departures::kAlone));
}

// The container loads it again; to unload or to load it meanwhile would be in the way of that.
std::optional<Governor::Held> Governor::container_to_come(const Strategy& strategy) const {
  for (const ComponentId component : strategy.components) {
    const auto container = awaited_container(component, knowledge_);
    const bool is_its_own = container && std::ranges::count(strategy.components, *container) > 0;
    if (container && !is_its_own)
      return Held{Restraint::kContainer,
                  knowledge_.rules[component].name + " ended with its container " +
                      knowledge_.rules[*container].name + ", which is being replaced and loads it",
                  later(knowledge_.now, knowledge_.rules.cycle)};
  }
  return std::nullopt;
}

bool Governor::stays_anything_down() const {
  for (std::size_t c = 0; c < knowledge_.rules.components.size(); ++c) {
    if (knowledge_.departures.stays_down(ComponentId(c))) return true;
  }
  return false;
}

std::optional<Governor::Held> Governor::lack_of_evidence(const Strategy& strategy, Time now) const {
  if (!options_.needs_evidence) return std::nullopt;
  if (auto reason = execute::contradiction(strategy, knowledge_, now))
    return Held{Restraint::kEvidence, std::move(*reason), kNever};
  if (auto answer = execute::answer_to_come(strategy, knowledge_, now))
    return Held{Restraint::kEvidence, std::move(answer->reason), answer->until};
  return std::nullopt;
}

std::optional<Governor::Held> Governor::restraint_by_person(StrategyId id) const {
  const Strategy& strategy = knowledge_.rules[id];
  for (const ActiveSilence& silence : silences_) {
    if (!touches(strategy, silence.what)) continue;
    const auto* component = std::get_if<ComponentId>(&silence.what);
    const std::string& what = component != nullptr ? knowledge_.rules[*component].name
                                                   : knowledge_.rules[strategy.rule].name;
    return Held{Restraint::kSilenced,
                what + " is muted by " + silence.author +
                    (silence.reason.empty() ? "" : ": " + silence.reason),
                silence.until};
  }
  const Time refused = refused_[id.index];
  if (refused != kNever && refused == knowledge_.states[strategy.rule].failing_since)
    return Held{Restraint::kRefused, "a person refused it", kNever};
  return std::nullopt;
}

std::optional<Governor::Held> Governor::interlock() const {
  for (const Interlock& interlock : knowledge_.rules.interlocks) {
    const Slot value = evaluate_now(interlock.condition, knowledge_);
    if (!value.known || !value.b)
      return Held{Restraint::kInterlock,
                  "INTERLOCK " + interlock.text + (value.known ? " is false" : " is unknown"),
                  kNever};
    const Time until = confirmed_by(interlock.condition, knowledge_.signals);
    if (knowledge_.now < until)
      return Held{Restraint::kInterlock,
                  "INTERLOCK " + interlock.text +
                      " was true before culprit missed messages, and no new value came yet",
                  until};
  }
  return std::nullopt;
}

bool Governor::awaits_approval(const ApprovalAsked& choice, Time now) {
  if (options_.approval == Approval::kNone) return false;
  if (const Question* question = question_of(choice.strategy)) return !question->is_approved;
  const RuleId rule = knowledge_.rules[choice.strategy].rule;
  // The question about another strategy of the same failure is no longer the question.
  std::erase_if(questions_, [&](const Question& question) {
    const bool is_old = !question.is_proposed && knowledge_.rules[question.strategy].rule == rule;
    if (is_old) write_.events.tell(now, ApprovalLapsed{question.strategy});
    return is_old;
  });
  questions_.push_back({choice.strategy, knowledge_.states[rule].failing_since});
  write_.events.tell(now, choice);
  return true;
}

void Governor::tell(ActionHeldBack what, const Held& held, Time now) {
  Told& told = told_[what.strategy.index];
  const Time since = knowledge_.states[knowledge_.rules[what.strategy].rule].failing_since;
  if (told.failing_since == since && told.restraint == held.restraint) return;
  told = {since, held.restraint};
  what.restraint = held.restraint;
  what.reason = held.reason;
  what.until = held.until;
  write_.events.tell(now, std::move(what));
}

void Governor::began(StrategyId strategy, Time now) {
  if (!knowledge_.rules[strategy].is_last_resort) limits_.began(strategy, now);
  told_[strategy.index] = {};
  std::erase_if(questions_, [&](const Question& q) { return q.strategy == strategy; });
}

// ---- time

bool Governor::is_open(const Question& question) const {
  const RuleState& state = knowledge_.states[knowledge_.rules[question.strategy].rule];
  const bool is_open =
      state.phase == RulePhase::kFailing ||
      (state.phase == RulePhase::kExhausted && question.is_proposed) ||
      (state.phase == RulePhase::kExhausted && knowledge_.goes_on(question.strategy));
  return is_open && state.failing_since == question.failing_since;
}

void Governor::advance(Time now) {
  storm_.advance(now);
  std::erase_if(silences_, [&](const ActiveSilence& silence) {
    if (silence.until > now) return false;
    write_.events.tell(now, SilenceEnded{silence.what});
    return true;
  });
  std::erase_if(questions_, [&](const Question& question) {
    if (is_open(question)) return false;
    write_.events.tell(now, ApprovalLapsed{question.strategy});
    return true;
  });
}

void Governor::note(std::span<const Event> events) {
  for (const Event& event : events) limits_.note(event);
  storm_.note(events);
}

Time Governor::next_deadline() const {
  Time next = storm_.next_deadline();
  for (const ActiveSilence& silence : silences_) next = std::min(next, silence.until);
  return next;
}

}  // namespace culprit
