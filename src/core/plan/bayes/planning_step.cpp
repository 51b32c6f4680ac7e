#include "plan/bayes/planning_step.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <tuple>

#include "diagnose/evidence.h"
#include "diagnose/known_down.h"
#include "diagnose/questions.h"
#include "plan/also_ended.h"
#include "plan/bayes/bayes_planner.h"
#include "plan/beside_exhausted.h"
#include "plan/ties.h"

namespace culprit::plan {

using namespace diagnose;

namespace {

// A strategy that costs more than it is worth has to be carried out all the same, once no other one
// comes first. So it is worth a little, by its index: how likely it resolves the failure for its
// cost.
std::int64_t worth(double value, double cost, double index) {
  constexpr double kLittle = 1e-4;
  return parts(std::max(value - cost, kLittle * std::min(index, 1.0))) + 1;
}

int redeployments(const Strategy& strategy) {
  return static_cast<int>(
      std::count_if(strategy.adaptations.begin(), strategy.adaptations.end(),
                    [](const Adaptation& a) { return a.type == AdaptationType::kRedeploy; }));
}

// Does it only switch to another source, or to another mode?
bool is_workaround(const Strategy& strategy) {
  return std::all_of(strategy.adaptations.begin(), strategy.adaptations.end(),
                     [](const Adaptation& a) {
                       return a.type == AdaptationType::kChangeCommunication ||
                              a.type == AdaptationType::kChangeMode;
                     });
}

// A workaround pays beside a repair that takes at least so much longer.
constexpr Duration kWorkaroundGain = std::chrono::seconds(5);

// Does it do nothing but replace processes that are known to be down?
bool only_revives(const Strategy& strategy, const Knowledge& knowledge) {
  const std::vector<ComponentId> others = also_ended(strategy, knowledge);
  return std::all_of(
             strategy.components.begin(), strategy.components.end(),
             [&](ComponentId c) { return is_known_down(c, knowledge) && replaces(strategy, c); }) &&
         std::all_of(others.begin(), others.end(),
                     [&](ComponentId c) { return is_known_down(c, knowledge); });
}

}  // namespace

PlanningStep::PlanningStep(std::span<const RuleId> failures, const Knowledge& knowledge,
                           const CostWeights& weights)
    : knowledge_(knowledge),
      weights_(weights),
      planned_(failures.begin(), failures.end()),
      found_(knowledge, failures),
      causes_(found_.causes()),
      diagnosis_(found_.diagnosis()),
      unheard_(all_unheard()),
      levels_(knowledge, causes_, diagnosis_),
      chances_(all_chances()),
      exclusions_(knowledge, found_, levels_, worked_on()),
      has_choice_(causes_.size(), false),
      tries_(causes_.size()),
      asks_(causes_.size()) {}

std::vector<Decision> PlanningStep::run() {
  find_stakes();
  examine_all();
  revive();
  for (const Criticality level :
       {Criticality::kError, Criticality::kWarning, Criticality::kNonCritical})
    select(level);
  go_round();
  await_answers();
  ask_again();
  return decisions();
}

std::vector<std::vector<StrategyChance>> PlanningStep::all_chances() const {
  std::vector<std::vector<StrategyChance>> all(causes_.size());
  for (const RuleId rule : planned_)
    all[causes_.index_of(rule)] = strategy_chances(rule, knowledge_);
  return all;
}

// The failures for which a strategy may begin without a person, now or later. No failure need make
// way for the others.
std::vector<RuleId> PlanningStep::worked_on() const {
  std::vector<RuleId> rules;
  std::copy_if(planned_.begin(), planned_.end(), std::back_inserter(rules),
               [&](RuleId rule) { return !waits_for_person(causes_.index_of(rule)); });
  return rules;
}

bool PlanningStep::waits_for_person(std::size_t failure) const {
  const auto cause = cause_of(failure);
  const auto is_in_vain = [&](StrategyId id) {
    return (cause || unheard_[failure]) && !only_revives(knowledge_.rules[id], knowledge_) &&
           !may_be_tried_beside_exhausted(id, knowledge_) &&
           (unheard_[failure] || is_left_to_person(*cause));
  };
  bool is_anything_left = false;
  for (const StrategyChance& each : chances_[failure]) {
    is_anything_left |= each.is_unheard();
    if (each.is_out()) continue;
    is_anything_left = true;
    const StrategyId id = each.strategy;
    const bool is_held = each.is_withheld && knowledge_.withheld[id.index].until == kNever;
    if (!is_held && !is_in_vain(id)) return false;
  }
  return is_anything_left;
}

std::vector<std::optional<ComponentId>> PlanningStep::all_unheard() const {
  std::vector<std::optional<ComponentId>> all(causes_.size());
  for (std::size_t i = 0; knowledge_.components.is_any_unreached() && i < all.size(); ++i)
    all[i] = unheard_behind(i);
  return all;
}

// As Knowledge::unheard_behind(), but without what is seen to be well.
std::optional<ComponentId> PlanningStep::unheard_behind(std::size_t failure) const {
  if (causes_[failure].kind != CauseNode::Kind::kFailure) return std::nullopt;
  const RuleId rule = causes_[failure].rule;
  if (!knowledge_.unheard_behind(rule)) return std::nullopt;
  std::optional<ComponentId> found;
  const auto look = [&](ComponentId c) {
    if (!found && knowledge_.is_unheard(c) && !knowledge_.is_older_than_silence(rule, c)) found = c;
  };
  for (const ComponentId c : knowledge_.rules[rule].components) {
    look(c);
    for_each(found_.paths().upstream(found_.reach().place_of(c), rule),
             [&](std::size_t place) { look(found_.reach()[place]); });
  }
  return found;
}

// It is exhausted, or nothing may be begun for it without a person: no rule that can see touches a
// component in trouble, or no node supplies an input.
bool PlanningStep::is_left_to_person(std::size_t node) const {
  switch (causes_[node].kind) {
    case CauseNode::Kind::kFailure:
      return knowledge_.states.awaits_person(causes_[node].rule) || waits_for_person(node);
    case CauseNode::Kind::kImminent:
      return false;
    case CauseNode::Kind::kTrouble: {
      const auto rules = knowledge_.states.touching(causes_[node].component);
      return std::none_of(rules.begin(), rules.end(), [&](RuleId rule) {
        return knowledge_.states[rule].detection.trigger.known;
      });
    }
    case CauseNode::Kind::kUnsupplied:
      return true;
  }
  return true;
}

// The likeliest cause outside its loop, if the failure more likely has one than not; or else the
// member of its loop that is known to be dead.
std::optional<std::size_t> PlanningStep::cause_of(std::size_t failure) const {
  if (diagnosis_.against_others(failure) >= 0.5) return diagnosis_.dead_in_loop(failure);
  std::int64_t most = 0;
  std::size_t cause = failure;
  diagnosis_.for_each_share(failure, [&](std::size_t j, double share) {
    if (parts(share) > most) std::tie(most, cause) = std::pair(parts(share), j);
  });
  return most > 0 ? std::optional(cause) : std::nullopt;
}

// By level, then by worth, then by name, which failures are in the order of.
bool PlanningStep::is_before(const WeighedCandidate& a, const WeighedCandidate& b) const {
  const auto key = [&](const WeighedCandidate& e) {
    return std::tuple<int, std::int64_t, std::int64_t, std::size_t, const std::string&>(
        -static_cast<int>(e.level), -e.worth, e.cost, e.failure,
        knowledge_.rules[e.candidate.strategy].name);
  };
  return key(a) < key(b);
}

void PlanningStep::find_stakes() {
  stakes_.resize(causes_.size());
  const auto weight_of = [&](std::size_t i) {
    return causes_[i].kind == CauseNode::Kind::kFailure
               ? weight(knowledge_.rules[causes_[i].rule].policies.criticality)
               : 0;
  };
  for (std::size_t i = 0; i < causes_.size(); ++i) stakes_[i] += weight_of(i);
  // Whichever member of a loop was first, the others clear with it.
  for (const auto& loop : causes_.loops()) {
    for (const std::size_t i : loop) {
      for (const std::size_t k : loop) {
        if (k != i) stakes_[i] += diagnosis_.kappa(i, k) * weight_of(k);
      }
    }
  }
  for (std::size_t k = 0; k < causes_.size(); ++k) {
    diagnosis_.for_each_share(
        k, [&](std::size_t i, double share) { stakes_[i] += share * weight_of(k); });
    if (causes_[k].kind != CauseNode::Kind::kFailure) continue;
    // Failures that are not downstream, but were seen to clear with another one.
    for (const auto& [cause, coupling] : knowledge_.couplings.of(causes_[k].rule)) {
      if (!knowledge_.states.is_active(cause) || coupling.cleared == 0) continue;
      const std::size_t i = causes_.index_of(cause);
      if (i != k && !has(causes_.causes(k), i))
        stakes_[i] += coupling.mean(Coupling::kRare) * weight_of(k);
    }
  }
}

void PlanningStep::examine_all() {
  std::size_t count = 0;
  for (const auto& of_failure : chances_) count += of_failure.size();
  weighed_.reserve(count);
  for (const RuleId rule : planned_) examine(causes_.index_of(rule));
  best_first_.reserve(count);
  for (WeighedCandidate& weighed : weighed_) best_first_.push_back(&weighed);
  std::sort(
      best_first_.begin(), best_first_.end(),
      [&](const WeighedCandidate* a, const WeighedCandidate* b) { return is_before(*a, *b); });
}

void PlanningStep::examine(std::size_t failure) {
  const std::vector<StrategyChance>& all = chances_[failure];
  const std::vector<Try> tries = tries_of(failure, all);
  std::vector<std::size_t> order(all.size());  // p/c index
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const auto key = [&](std::size_t s) {
      return std::tuple<std::int64_t, const std::string&, std::size_t>(
          -parts(index(tries[s])), knowledge_.rules[all[s].strategy].name, s);
    };
    return key(a) < key(b);
  });
  std::vector<Try> possible;
  possible.reserve(all.size());
  double helps = 0;
  for (const std::size_t s : order) {
    if (!all[s].is_out() && !all[s].is_withheld) possible.push_back(tries[s]);
    helps += all[s].chance;
  }
  const std::vector<double> costs = expected_costs(possible);
  tries_[failure] = std::move(possible);
  const double root = diagnosis_.of(failure);

  std::size_t next = 0;
  for (const std::size_t s : order) {
    WeighedCandidate& weighed = weighed_.emplace_back();
    weighed.failure = failure;
    weighed.level = levels_.of(causes_[failure].rule);
    weighed.candidate.strategy = all[s].strategy;
    weighed.affected = exclusions_.affected(knowledge_.rules[all[s].strategy]);
    if (all[s].is_tried) {
      weighed.candidate.excluded = Condition::kTried;
    } else if (all[s].invalid) {
      exclude_invalid(weighed, *all[s].invalid);
    } else if (all[s].is_withheld) {
      weighed.candidate.excluded = Condition::kWithheld;
      weighed.candidate.component = knowledge_.rules[all[s].strategy].components.front();
      weighed.candidate.remark = knowledge_.withheld[all[s].strategy.index].reason;
    } else {
      weighed.candidate.resolves = root * all[s].chance;
      weighed.candidate.value = root * std::min(1.0, helps) * stakes_[failure];
      weighed.candidate.cost = costs[next];
      weighed.cost = parts(costs[next]);
      weighed.only_revives = only_revives(knowledge_.rules[all[s].strategy], knowledge_);
      weighed.place = next++;
      weighed.worth =
          worth(weighed.candidate.value, weighed.candidate.cost, root * index(tries[s]));
      exclude(weighed, all[s].chance);
    }
  }
}

std::vector<Try> PlanningStep::tries_of(std::size_t failure,
                                        const std::vector<StrategyChance>& chances) const {
  const Duration latency = knowledge_.signals.latency(causes_[failure].rule);
  std::vector<Try> all;
  all.reserve(chances.size());
  for (const StrategyChance& each : chances) {
    const Strategy& strategy = knowledge_.rules[each.strategy];
    const Effort effort{strategy.impact, latency, redeployments(strategy), disruption(strategy)};
    all.push_back({each.chance, try_cost(effort, weights_, knowledge_.rules),
                   time_cost(effort, weights_, knowledge_.rules), each.luck});
  }
  return all;
}

double PlanningStep::disruption(const Strategy& strategy) const {
  std::size_t down = 0;
  const auto add = [&](ComponentId component) {
    down += 1 + found_.reach().dependents(found_.reach().place_of(component));
  };
  for (const Adaptation& adaptation : strategy.adaptations) {
    if (takes_down(adaptation)) add(adaptation.component);
  }
  for (const ComponentId component : also_ended(strategy, knowledge_)) add(component);
  const auto all = static_cast<double>(knowledge_.rules.components.size());
  return std::min(1.0, static_cast<double>(down) / all);
}

void PlanningStep::exclude(WeighedCandidate& weighed, double chance) const {
  const RuleId rule = causes_[weighed.failure].rule;
  const Strategy& strategy = knowledge_.rules[weighed.candidate.strategy];
  // The replacement of a dead process waits for no failure but one that has the component already.
  if (weighed.only_revives) {
    if (const auto held = exclusions_.reserved(weighed.level, weighed.affected))
      exclude(weighed, *held);
    return;
  }
  if (exclude_effect(weighed) || exclude_unproven(weighed, chance) ||
      exclude_coincidence(weighed) || exclude_transient(weighed))
    return;
  if (const auto held = exclusions_.reserved(weighed.level, weighed.affected))
    return exclude(weighed, *held);
  for (const std::size_t place : weighed.affected) {
    if (const auto obstacle = exclusions_.obstacle(place, strategy, chance))
      return exclude(weighed, *obstacle);
  }
  const auto& settling = knowledge_.states[rule].settling;
  const bool is_settling =
      settling && knowledge_.now < settling->until &&
      !knowledge_.signals.is_read_since(rule, settling->since) &&
      knowledge_.couplings.of(settling->with, rule).mean(Coupling::kUsual) > 0.5;
  if (is_settling)
    return exclude(weighed,
                   {Condition::kSettling, likeliest_component(settling->with), settling->with});
}

// Does it give way to a failure that repeatedly began together with it, so that one can see whose
// repair clears the other? Not to an effect, which waits itself. The one that was tried less goes
// first; of equals the one by name, and the other the next time.
bool PlanningStep::exclude_coincidence(WeighedCandidate& weighed) const {
  const RuleId rule = causes_[weighed.failure].rule;
  const auto tries = [&](RuleId id) {
    const Search& search = knowledge_.states[id].search;
    return search.attempts - search.attempts_before;
  };
  for (const RuleId other : knowledge_.coincidences.of(rule)) {
    if (!knowledge_.states.is_active(other) || cause_of(causes_.index_of(other))) continue;
    const auto& attempt = knowledge_.states[other].attempt;
    const bool is_other_spent =
        !attempt && knowledge_.states[other].search.retry_at > knowledge_.now;
    const bool is_even = knowledge_.coincidences.together(rule, other) % 2 == 0;
    const bool is_first_by_name =
        (knowledge_.rules[rule].name < knowledge_.rules[other].name) == is_even;
    const bool is_first =
        tries(rule) != tries(other) ? tries(rule) < tries(other) : is_first_by_name;
    if (is_other_spent || (!attempt && is_first)) continue;
    exclude(weighed, {Condition::kInTheWay, likeliest_component(other), other});
    return true;
  }
  return false;
}

// Does it wait because a cause upstream may still be detected, or because it may be the echo of one
// that has cleared?
bool PlanningStep::exclude_unproven(WeighedCandidate& weighed, double chance) const {
  const RuleId rule = causes_[weighed.failure].rule;
  const auto awaiting = found_.awaited().of(rule);
  if (!awaiting) return false;
  const bool need_not_wait =
      chance >= kSure && !takes_down(knowledge_.rules[weighed.candidate.strategy]);
  const bool is_coupled =
      awaiting->because == rule ||
      knowledge_.couplings.of(awaiting->because, rule).mean(Coupling::kUsual) > 0.5;
  if (need_not_wait || !is_coupled) return false;
  exclude(weighed, {awaiting->is_echo ? Condition::kSettling : Condition::kSuspect,
                    awaiting->begun_anew.value_or(likeliest_component(awaiting->because)),
                    awaiting->because});
  if (awaiting->begun_anew) weighed.candidate.remark = "was down for a strategy";
  return true;
}

// Is there a proof of the failure, or does it keep coming back and was not repaired yet?
bool PlanningStep::is_sure(RuleId rule) const {
  constexpr int kOften = 3;
  const Search& search = knowledge_.states[rule].search;
  return is_known_down(rule, knowledge_) || (search.times >= kOften && search.attempts == 0) ||
         std::ranges::any_of(knowledge_.rules[rule].components, [&](ComponentId c) {
           const auto& trouble = found_.troubles()[c.index];
           return trouble && trouble->trouble != diagnose::Trouble::kSilent;
         });
}

// Is it left alone at first, since it will likely clear by itself? (knowledge/transients.h) Only if that
// is worth the time that it costs otherwise.
bool PlanningStep::exclude_transient(WeighedCandidate& weighed) const {
  const RuleId rule = causes_[weighed.failure].rule;
  const Transients& transients = knowledge_.transients;
  const Duration patience = transients.patience(rule);
  if (knowledge_.now >= later(knowledge_.states[rule].first_detected(), patience) || is_sure(rule))
    return false;
  const double share = transients.share(rule);
  const Effort waiting{Cycles{0}, transients.longest(rule)};
  const double lost = time_cost(waiting, weights_, knowledge_.rules);
  if (share * weighed.candidate.cost < (1 - share) * lost) return false;
  exclude(weighed, {Condition::kSettling, likeliest_component(rule), rule});
  weighed.candidate.remark = "such failures often clear by themselves";
  return true;
}

void PlanningStep::exclude(WeighedCandidate& weighed, const Exclusions::Obstacle& obstacle) const {
  weighed.candidate.excluded = obstacle.condition;
  weighed.candidate.component = obstacle.component;
  weighed.candidate.failure = obstacle.because;
}

// A strategy that is invalid now may become valid once the adaptation of its component is over.
void PlanningStep::exclude_invalid(WeighedCandidate& weighed, const Invalid& why) const {
  if (const auto held = exclusions_.reserved(weighed.level, weighed.affected))
    return exclude(weighed, *held);
  weighed.candidate.excluded = why.is_unheard ? Condition::kUnheard : Condition::kInvalid;
  weighed.candidate.component = why.component;
  weighed.candidate.remark = why.reason;
}

// Is it a workaround that restores the function much sooner than the repair of the cause, with whatever
// strategy that is under way or would be begun?
bool PlanningStep::is_quicker_than_repair(StrategyId id, std::size_t cause) const {
  const Strategy& strategy = knowledge_.rules[id];
  if (!is_workaround(strategy) || causes_[cause].kind != CauseNode::Kind::kFailure) return false;
  const RuleId rule = causes_[cause].rule;
  std::optional<Cycles> repair;
  if (const auto& attempt = knowledge_.states[rule].attempt) {
    repair = knowledge_.rules[attempt->strategy].impact;
  } else {
    for (const StrategyChance& each : chances_[cause]) {
      const Cycles impact = knowledge_.rules[each.strategy].impact;
      if (!each.is_out() && (!repair || impact < *repair)) repair = impact;
    }
  }
  return repair && duration_of(*repair, knowledge_.rules) >=
                       duration_of(strategy.impact, knowledge_.rules) + kWorkaroundGain;
}

// Workarounds begin beside the repair of their cause: they take nothing down.
void PlanningStep::go_round() {
  for (WeighedCandidate* weighed : best_first_) {
    if (!weighed->goes_round || weighed->candidate.excluded) continue;
    if (has_choice_[weighed->failure]) {
      weighed->candidate.excluded = Condition::kOneEach;
      continue;
    }
    if (const auto held = exclusions_.reserved(weighed->level, weighed->affected))
      exclude(*weighed, *held);
    for (const std::size_t place : weighed->affected) {
      if (const auto taken = exclusions_.taken(place)) exclude(*weighed, *taken);
    }
    if (!weighed->candidate.excluded) choose(*weighed);
  }
}

// The cause has been repaired, and counts as over once a group is active that this strategy brings up. If it waited for the
// cause, each would wait for the other.
bool PlanningStep::ends_wait_of(StrategyId id, std::size_t cause) const {
  if (causes_[cause].kind != CauseNode::Kind::kFailure) return false;
  const RuleId rule = causes_[cause].rule;
  const RuleState& state = knowledge_.states[rule];
  const auto& awaited = knowledge_.rules[rule].groups;
  const Slot& trigger = state.detection.trigger;
  return !state.attempt && trigger.known && !trigger.b &&
         std::ranges::any_of(knowledge_.rules[id].adaptations, [&](const Adaptation& each) {
           return each.group && std::ranges::find(awaited, *each.group) != awaited.end();
         });
}

// Does it wait for a cause that more likely explains it?
bool PlanningStep::exclude_effect(WeighedCandidate& weighed) const {
  const StrategyId strategy = weighed.candidate.strategy;
  if (const auto cause = cause_of(weighed.failure)) {
    if (ends_wait_of(strategy, *cause)) return false;
    const bool goes_round =
        may_be_tried_beside_exhausted(strategy, knowledge_) && is_left_to_person(*cause);
    weighed.goes_round = !goes_round && is_quicker_than_repair(strategy, *cause);
    if (!goes_round && !weighed.goes_round) exclude_for(weighed, *cause);
    return !goes_round;
  }
  // A failure of a component that is on an unreachable computer, or depends on one, waits until it
  // is reachable.
  if (const auto unheard = unheard_[weighed.failure]) {
    if (may_be_tried_beside_exhausted(strategy, knowledge_)) return false;
    exclude(weighed, {Condition::kUnheard, *unheard, {}});
    weighed.candidate.remark = knowledge_.why_unheard(*unheard);
    return true;
  }
  // In a feedback loop the members take turns, whichever is the likelier; a likelier one that has not
  // fired yet is waited for.
  for (const std::size_t j : causes_.loops()[causes_.loop_of(weighed.failure)]) {
    const bool is_likelier = parts(diagnosis_.of(j)) > parts(diagnosis_.of(weighed.failure));
    if (causes_[j].kind != CauseNode::Kind::kImminent || !is_likelier) continue;
    exclude_for(weighed, j);
    return true;
  }
  return false;
}

void PlanningStep::exclude_for(WeighedCandidate& weighed, std::size_t cause) const {
  const CauseNode& node = causes_[cause];
  const bool has_fired = node.kind == CauseNode::Kind::kFailure;
  Exclusions::Obstacle obstacle{Condition::kDependency, component_of(cause), {}};
  if (node.is_rule()) obstacle.because = node.rule;
  if (node.is_rule() && !has_fired) obstacle.condition = Condition::kSuspect;
  exclude(weighed, obstacle);
  if (node.kind == CauseNode::Kind::kTrouble) weighed.candidate.remark = to_string(node.trouble);
  if (node.kind == CauseNode::Kind::kUnsupplied)
    weighed.candidate.remark = "needs " + node.channel + ", which no node offers";
}

// The dead are replaced side by side, whatever depends on whatever and however critical it is.
void PlanningStep::revive() {
  for (WeighedCandidate* weighed : best_first_) {
    if (weighed->candidate.excluded || !weighed->only_revives) continue;
    if (has_choice_[weighed->failure]) {
      weighed->candidate.excluded = Condition::kOneEach;
      continue;
    }
    for (const ComponentId c : knowledge_.rules[weighed->candidate.strategy].components) {
      if (const auto taken = exclusions_.taken(found_.reach().place_of(c)))
        exclude(*weighed, *taken);
    }
    if (!weighed->candidate.excluded) choose(*weighed);
  }
}

// Before something is taken down, those upstream that may hang are asked. It goes on waiting in the
// place that it was chosen for: nothing that it stands against is begun meanwhile.
void PlanningStep::await_answers() {
  for (WeighedCandidate* weighed : best_first_) {
    const Strategy& strategy = knowledge_.rules[weighed->candidate.strategy];
    const bool has_to_wait =
        !weighed->candidate.excluded && !weighed->only_revives && takes_down(strategy);
    if (!has_to_wait) continue;
    Questions questions =
        questions_about(causes_[weighed->failure].rule, found_.troubles(), knowledge_);
    asks_[weighed->failure] = std::move(questions.asks);
    if (questions.lost) {
      exclude(*weighed, {Condition::kDependency, questions.lost->publisher, {}});
      weighed->candidate.remark = diagnose::in_words(*questions.lost, knowledge_);
    }
    if (!questions.awaited) continue;
    exclude(*weighed, {Condition::kSuspect, *questions.awaited, {}});
    weighed->candidate.remark = "asked whether it answers";
  }
}

// While one that did not answer explains a failure, it is asked again: it may only have been busy.
void PlanningStep::ask_again() {
  for (const RuleId rule : planned_) {
    const std::size_t failure = causes_.index_of(rule);
    const auto cause = cause_of(failure);
    if (has_choice_[failure] || !cause || causes_[*cause].kind != CauseNode::Kind::kTrouble)
      continue;
    const ComponentId component = causes_[*cause].component;
    if (is_to_be_asked_again(component, knowledge_)) asks_[failure].push_back(component);
  }
}

void PlanningStep::choose(const WeighedCandidate& weighed) {
  has_choice_[weighed.failure] = true;
  sides_.push_back({tries_[weighed.failure], {weighed.place}});
  using enum Exclusions::Disturbance;
  exclusions_.add(causes_[weighed.failure].rule, weighed.affected,
                  weighed.only_revives ? kNone : kFromUpstream);
}

// Does what was chosen before stand against it? Then it is excluded.
bool PlanningStep::is_taken(WeighedCandidate& weighed) const {
  if (has_choice_[weighed.failure]) {
    weighed.candidate.excluded = Condition::kOneEach;
    return true;
  }
  for (const std::size_t place : weighed.affected) {
    const auto conflict = exclusions_.conflict(place);
    if (!conflict) continue;
    exclude(weighed, *conflict);
    return true;
  }
  return false;
}

void PlanningStep::select(Criticality level) {
  std::vector<WeighedCandidate*> open;
  for (WeighedCandidate* weighed : best_first_) {
    const bool is_next = !weighed->candidate.excluded && weighed->level == level &&
                         !weighed->only_revives && !weighed->goes_round;
    if (is_next && !is_taken(*weighed)) open.push_back(weighed);
  }

  const std::vector<WeighedCandidate*> chosen = weigh_together(open, chosen_together(open));
  for (const WeighedCandidate* weighed : chosen) choose(*weighed);
  for (WeighedCandidate* weighed : open) {
    if (std::find(chosen.begin(), chosen.end(), weighed) == chosen.end()) is_taken(*weighed);
  }
}

// The conflict-free ones of the highest total worth.
std::vector<PlanningStep::WeighedCandidate*> PlanningStep::chosen_together(
    const std::vector<WeighedCandidate*>& open) const {
  BitRows takes(open.size(), found_.reach().size());
  BitRows near(open.size(), found_.reach().size());
  std::vector<Item> items;
  for (std::size_t e = 0; e < open.size(); ++e) {
    for (const std::size_t place : open[e]->affected) {
      set(takes[e], place);
      add(near[e], found_.reach().upstream(place));
      add(near[e], found_.reach().downstream(place));
    }
    add(near[e], takes[e]);
    items.push_back({open[e]->failure, open[e]->worth, takes[e], near[e]});
  }
  std::vector<WeighedCandidate*> chosen;
  for (const std::size_t e : best_conflict_free_set(items)) chosen.push_back(open[e]);
  return chosen;
}

// Chooses, for the same failures at the same components, the strategies that cost the least beside
// each other.
std::vector<PlanningStep::WeighedCandidate*> PlanningStep::weigh_together(
    const std::vector<WeighedCandidate*>& open,
    const std::vector<WeighedCandidate*>& chosen) const {
  std::vector<Side> sides = sides_;
  std::vector<std::vector<WeighedCandidate*>> firsts;
  for (WeighedCandidate* usual : chosen) {
    auto& all = firsts.emplace_back(1, usual);
    const auto& components = knowledge_.rules[usual->candidate.strategy].components;
    std::copy_if(open.begin(), open.end(), std::back_inserter(all),
                 [&](const WeighedCandidate* other) {
                   return other != usual && other->failure == usual->failure &&
                          knowledge_.rules[other->candidate.strategy].components == components;
                 });
    Side& side = sides.emplace_back(Side{tries_[usual->failure], {}});
    for (const WeighedCandidate* weighed : all) side.firsts.push_back(weighed->place);
  }
  const std::vector<std::size_t> begins = side_by_side(sides);
  std::vector<WeighedCandidate*> together;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const std::size_t place = begins[sides_.size() + i];
    together.push_back(
        *std::find_if(firsts[i].begin(), firsts[i].end(),
                      [&](const WeighedCandidate* weighed) { return weighed->place == place; }));
  }
  return together;
}

// The first member that is not up, of a group that a strategy of the rule brings up; its manager if all are.
std::optional<ComponentId> PlanningStep::missing_member(RuleId rule) const {
  for (const StrategyId strategy : knowledge_.rules[rule].strategies) {
    for (const Adaptation& adaptation : knowledge_.rules[strategy].adaptations) {
      if (!adaptation.group) continue;
      const Group& group = knowledge_.rules[*adaptation.group];
      const auto missing = std::ranges::find_if(group.members, [&](ComponentId id) {
        const ComponentState& state = knowledge_.components[id];
        return state.alive == false || state.lifecycle != Lifecycle::kActive;
      });
      return missing == group.members.end() ? group.manager : *missing;
    }
  }
  return std::nullopt;
}

// The component at which the rule's untried strategies are most likely to help.
ComponentId PlanningStep::likeliest_component(RuleId rule) const {
  if (knowledge_.rules[rule].components.size() == 1) return knowledge_.rules[rule].components[0];
  if (const auto missing = missing_member(rule)) return *missing;
  std::pair<std::int64_t, ComponentId> best{-1, {}};
  for (const ComponentId c : knowledge_.rules[rule].components) {
    double chance = 0;
    for (const StrategyId s : knowledge_.rules[rule].strategies) {
      const auto& adapted = knowledge_.rules[s].components;
      if (std::binary_search(adapted.begin(), adapted.end(), c))
        chance += knowledge_.beliefs[s].mean().value;
    }
    const bool is_better = parts(chance) > best.first ||
                           (parts(chance) == best.first &&
                            knowledge_.rules[c].name < knowledge_.rules[best.second].name);
    if (is_better) best = {parts(chance), c};
  }
  return best.second;
}

ComponentId PlanningStep::component_of(std::size_t node) const {
  return causes_[node].is_rule() ? likeliest_component(causes_[node].rule)
                                 : causes_[node].component;
}

std::vector<Suspect> PlanningStep::suspects(std::size_t failure) const {
  std::vector<std::pair<Suspect, std::size_t>> all;  // with their nodes
  const RuleId rule = causes_[failure].rule;
  all.push_back({{likeliest_component(rule), rule, diagnosis_.of(failure)}, failure});
  diagnosis_.for_each_share(failure, [&](std::size_t j, double share) {
    all.push_back({{component_of(j), causes_[j].is_rule() ? causes_[j].rule : rule, share}, j});
  });
  const std::size_t shown = std::min(all.size(), BayesPlanner::kSuspects);
  std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(shown), all.end(),
                    [&](const auto& a, const auto& b) {
                      const auto key = [&](const Suspect& s) {
                        return std::pair<std::int64_t, const std::string&>(
                            -parts(s.probability), knowledge_.rules[s.failure].name);
                      };
                      return key(a.first) < key(b.first);
                    });
  all.resize(shown);
  std::vector<Suspect> suspects;
  for (auto& [suspect, node] : all) {
    suspect.evidence = evidence_for(node, failure, found_, knowledge_);
    suspects.push_back(std::move(suspect));
  }
  return suspects;
}

std::vector<Decision> PlanningStep::decisions() {
  std::vector<Decision> found;
  found.reserve(planned_.size());
  std::vector<std::size_t> place(causes_.size(), causes_.size());
  for (WeighedCandidate* weighed : best_first_) {
    std::size_t& at = place[weighed->failure];
    if (at == causes_.size()) {
      at = found.size();
      found.push_back({causes_[weighed->failure].rule,
                       {},
                       true,
                       {},
                       suspects(weighed->failure),
                       std::move(asks_[weighed->failure])});
      found.back().candidates.reserve(chances_[weighed->failure].size());
    }
    Decision& decision = found[at];
    const auto& excluded = weighed->candidate.excluded;
    if (!excluded) decision.chosen = weighed->candidate.strategy;
    decision.is_spent &= excluded == Condition::kTried || excluded == Condition::kInvalid;
    decision.candidates.push_back(std::move(weighed->candidate));
  }
  return found;
}

}  // namespace culprit::plan
