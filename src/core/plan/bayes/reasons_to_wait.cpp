#include "plan/bayes/reasons_to_wait.h"

#include <algorithm>

#include "diagnose/known_down.h"
#include "plan/awaits_valid_strategy.h"
#include "plan/beside_exhausted.h"
#include "plan/ties.h"

namespace culprit::plan {

using namespace diagnose;

namespace {

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

}  // namespace

void ReasonsToWait::look_at(WeighedCandidate& weighed, double chance) const {
  const RuleId rule = causes_[weighed.failure].rule;
  const Strategy& strategy = knowledge_.rules[weighed.candidate.strategy];
  // The replacement of a dead process waits for no failure but one that has the component already.
  if (weighed.only_revives) {
    if (const auto held = exclusions_.reserved(weighed.level, weighed.affected))
      exclude(weighed, *held);
    return;
  }
  if (exclude_effect(weighed) || exclude_unproven(weighed, chance) ||
      exclude_coincidence(weighed) || exclude_transient(weighed) || exclude_beside_held(weighed))
    return;
  if (const auto held = exclusions_.reserved(weighed.level, weighed.affected))
    return exclude(weighed, *held);
  for (const std::size_t place : weighed.affected) {
    if (const auto obstacle = exclusions_.obstacle(place, strategy, chance))
      return exclude(weighed, *obstacle);
  }
  if (is_settling(rule)) {
    const Settling& settling = *knowledge_.states[rule].settling;
    exclude(weighed,
            {Condition::kSettling, likely_.likeliest_component(settling.with), settling.with});
    ends(weighed, settles_by(rule, settling.since, settling.until, knowledge_));
  }
}

bool ReasonsToWait::is_settling(RuleId rule) const {
  const auto& settling = knowledge_.states[rule].settling;
  return settling &&
         knowledge_.now < settles_by(rule, settling->since, settling->until, knowledge_) &&
         !knowledge_.signals.is_read_since(rule, settling->since) &&
         knowledge_.couplings.of(settling->with, rule).clears(Coupling::kUsual) > 0.5;
}

// Will `other` likely fire in time for a failure that waits for it?
bool ReasonsToWait::is_about_to_fire(RuleId other, RuleId failure) const {
  return causes_.holds(other) &&
         causes_[causes_.index_of(other)].kind == CauseNode::Kind::kImminent &&
         knowledge_.now < later(knowledge_.states[failure].first_detected(), kLongestEvidence);
}

// Does it give way to a failure that repeatedly began together with it, so that one can see whose
// repair clears the other? Not to an effect, which waits itself. The one that was tried less goes
// first; of equals the one by name, and the other the next time.
bool ReasonsToWait::exclude_coincidence(WeighedCandidate& weighed) const {
  const RuleId rule = causes_[weighed.failure].rule;
  const auto tries = [&](RuleId id) {
    const Search& search = knowledge_.states[id].search;
    return search.attempts - search.attempts_before;
  };
  for (const RuleId other : knowledge_.coincidences.of(rule)) {
    if (is_about_to_fire(other, rule)) {
      exclude(weighed, {Condition::kSuspect, likely_.likeliest_component(other), other});
      return true;
    }
    if (!knowledge_.states.is_active(other) || likely_.of(causes_.index_of(other))) continue;
    const auto& attempt = knowledge_.states[other].attempt;
    const bool is_other_spent =
        !attempt && knowledge_.states[other].search.retry_at > knowledge_.now;
    const bool is_even = knowledge_.coincidences.together(rule, other) % 2 == 0;
    const bool is_first_by_name =
        (knowledge_.rules[rule].name < knowledge_.rules[other].name) == is_even;
    const bool is_first =
        tries(rule) != tries(other) ? tries(rule) < tries(other) : is_first_by_name;
    if (is_other_spent || (!attempt && is_first)) continue;
    exclude(weighed, {Condition::kInTheWay, likely_.likeliest_component(other), other});
    return true;
  }
  return false;
}

// Does it wait because a cause upstream may still be detected, or because it may be the echo of one
// that has cleared?
bool ReasonsToWait::exclude_unproven(WeighedCandidate& weighed, double chance) const {
  const RuleId rule = causes_[weighed.failure].rule;
  const auto awaiting = found_.awaited().of(rule);
  if (!awaiting) return false;
  const bool is_own_window = awaiting->because == rule && !awaiting->component;
  const bool need_not_wait = chance >= kSure && !is_own_window &&
                             !takes_down(knowledge_.rules[weighed.candidate.strategy]);
  const Coupling coupling = knowledge_.couplings.of(awaiting->because, rule);
  const bool is_coupled =
      awaiting->because == rule || (awaiting->is_echo ? coupling.clears(Coupling::kUsual)
                                                      : coupling.mean(Coupling::kUsual)) > 0.5;
  if (need_not_wait || !is_coupled) return false;
  const bool was_in_trouble = awaiting->component && awaiting->because == rule;
  exclude(weighed, {awaiting->is_echo ? Condition::kSettling : Condition::kSuspect,
                    awaiting->component.value_or(likely_.likeliest_component(awaiting->because)),
                    was_in_trouble ? std::nullopt : std::optional(awaiting->because)});
  ends(weighed, awaiting->until);
  if (is_own_window)
    weighed.candidate.remark = "its window still holds the time before its repair";
  else if (awaiting->component)
    weighed.candidate.remark = was_in_trouble ? "was in trouble" : "was down for a strategy";
  return true;
}

// Is there a proof of the failure, or does it keep coming back and was not repaired yet?
bool ReasonsToWait::is_sure(RuleId rule) const {
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
bool ReasonsToWait::exclude_transient(WeighedCandidate& weighed) const {
  const RuleId rule = causes_[weighed.failure].rule;
  const Transients& transients = knowledge_.transients;
  const Duration patience = transients.patience(rule);
  if (knowledge_.now >= later(knowledge_.states[rule].first_detected(), patience) || is_sure(rule))
    return false;
  const double share = transients.share(rule);
  const Effort waiting{Cycles{0}, transients.longest(rule)};
  const double lost = time_cost(waiting, weights_, knowledge_.rules);
  if (share * weighed.candidate.cost < (1 - share) * lost) return false;
  exclude(weighed, {Condition::kSettling, likely_.likeliest_component(rule), rule});
  ends(weighed, later(knowledge_.states[rule].first_detected(), patience));
  weighed.candidate.remark = "such failures often clear by themselves";
  return true;
}

// Is the strategy held back for a moment that mends what is evidently in trouble? No other one is begun in its place.
bool ReasonsToWait::exclude_beside_held(WeighedCandidate& weighed) const {
  const std::vector<StrategyChance>& all = likely_.chances(weighed.failure);
  const auto own = std::ranges::find(all, weighed.candidate.strategy, &StrategyChance::strategy);
  const RuleId rule = causes_[weighed.failure].rule;
  const Time longest = later(knowledge_.states[rule].failing_since, kLongestEvidence);
  if (!own->leaves_ill || knowledge_.now >= longest) return false;
  const auto held = std::ranges::find_if(all, [&](const StrategyChance& each) {
    return !each.is_out() && !each.leaves_ill && each.is_withheld &&
           knowledge_.withheld[each.strategy.index].until <= longest;
  });
  if (held == all.end()) return false;
  const auto& why = knowledge_.withheld[held->strategy.index];
  weighed.candidate.excluded = Condition::kWithheld;
  weighed.candidate.component = knowledge_.rules[held->strategy].components.front();
  weighed.candidate.remark = why.reason;
  ends(weighed, why.until);
  return true;
}

// A strategy that is invalid now may become valid once the adaptation of its component is over.
void ReasonsToWait::look_at(WeighedCandidate& weighed, const Invalid& why) const {
  if (const auto held = exclusions_.reserved(weighed.level, weighed.affected))
    return exclude(weighed, *held);
  weighed.candidate.excluded = why.waits ? Condition::kUnheard : Condition::kInvalid;
  weighed.candidate.component = why.component;
  weighed.candidate.remark = why.reason;
}

// Is it a workaround that restores the function much sooner than the repair of the cause, with whatever
// strategy that is under way or would be begun?
bool ReasonsToWait::is_quicker_than_repair(StrategyId id, std::size_t cause) const {
  const Strategy& strategy = knowledge_.rules[id];
  if (!is_workaround(strategy) || causes_[cause].kind != CauseNode::Kind::kFailure) return false;
  const RuleId rule = causes_[cause].rule;
  std::optional<Cycles> repair;
  if (const auto& attempt = knowledge_.states[rule].attempt) {
    repair = knowledge_.rules[attempt->strategy].impact;
  } else {
    for (const StrategyChance& each : likely_.chances(cause)) {
      const Cycles impact = knowledge_.rules[each.strategy].impact;
      if (!each.is_out() && (!repair || impact < *repair)) repair = impact;
    }
  }
  if (!repair) return false;
  // A repair that has taken so long already will presumably take as long again.
  const Duration so_far = knowledge_.now - knowledge_.states[rule].failing_since;
  return std::max(so_far, duration_of(*repair, knowledge_.rules)) >=
         duration_of(strategy.impact, knowledge_.rules) + kWorkaroundGain;
}

// The cause has been repaired, and counts as over once a group is active that this strategy brings up. If it waited for the
// cause, each would wait for the other.
bool ReasonsToWait::ends_wait_of(StrategyId id, std::size_t cause) const {
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

// The cause has no possible strategy before this one has made one possible. If it waited for the cause, each
// would wait for the other.
bool ReasonsToWait::opens_way_for(StrategyId id, std::size_t cause) const {
  if (causes_[cause].kind != CauseNode::Kind::kFailure) return false;
  const RuleId rule = causes_[cause].rule;
  const std::vector<StrategyChance>& all = likely_.chances(cause);
  if (knowledge_.states[rule].attempt || knowledge_.states.awaits_person(rule)) return false;
  return std::ranges::all_of(all, [](const StrategyChance& each) { return each.is_out(); }) &&
         std::ranges::any_of(all, [&](const StrategyChance& each) {
           return each.invalid &&
                  makes_possible(knowledge_.rules[id], knowledge_.rules[each.strategy],
                                 *each.invalid, knowledge_);
         });
}

// Does the governor hold back all that is left to do for it, and something only until an answer is there?
bool ReasonsToWait::is_held_for_a_moment(std::size_t cause) const {
  constexpr Duration kMoment = std::chrono::seconds(2);
  if (causes_[cause].kind != CauseNode::Kind::kFailure) return false;
  bool is_any = false;
  for (const StrategyChance& each : likely_.chances(cause)) {
    if (each.is_out()) continue;
    if (!each.is_withheld) return false;
    is_any |= knowledge_.withheld[each.strategy.index].until <= later(knowledge_.now, kMoment);
  }
  return is_any;
}

// Does it wait for a cause that more likely explains it?
bool ReasonsToWait::exclude_effect(WeighedCandidate& weighed) const {
  const StrategyId strategy = weighed.candidate.strategy;
  if (const auto cause = likely_.of(weighed.failure)) {
    if (ends_wait_of(strategy, *cause) || opens_way_for(strategy, *cause)) return false;
    const bool goes_round =
        may_be_tried_beside_exhausted(strategy, knowledge_) && likely_.is_left_to_person(*cause);
    weighed.goes_round = !goes_round && is_quicker_than_repair(strategy, *cause);
    if (!goes_round && !weighed.goes_round) exclude_for(weighed, *cause);
    return !goes_round;
  }
  // A failure of a component that is on an unreachable computer, or depends on one, waits until it
  // is reachable.
  if (const auto unheard = likely_.unheard(weighed.failure)) {
    if (may_be_tried_beside_exhausted(strategy, knowledge_)) return false;
    exclude(weighed, {Condition::kUnheard, *unheard, {}});
    weighed.candidate.remark = knowledge_.why_unheard(*unheard);
    return true;
  }
  // In a feedback loop the members take turns, whichever is the likelier; a likelier one that has not
  // fired yet is waited for, and the first for a moment.
  for (const std::size_t j : causes_.loops()[causes_.loop_of(weighed.failure)]) {
    const bool is_likelier = parts(diagnosis_.of(j)) > parts(diagnosis_.of(weighed.failure));
    const bool is_first = causes_[j].first_onset < causes_[weighed.failure].first_onset;
    const bool comes_next = causes_[j].kind == CauseNode::Kind::kImminent
                                ? is_likelier
                                : (is_likelier || is_first) && is_held_for_a_moment(j);
    if (!comes_next) continue;
    exclude_for(weighed, j);
    return true;
  }
  return false;
}

void ReasonsToWait::exclude_for(WeighedCandidate& weighed, std::size_t cause) const {
  const CauseNode& node = causes_[cause];
  const bool has_fired = node.kind == CauseNode::Kind::kFailure;
  Exclusions::Obstacle obstacle{Condition::kDependency, likely_.component_of(cause), {}};
  if (node.is_rule()) obstacle.because = node.rule;
  if (node.is_rule() && !has_fired) obstacle.condition = Condition::kSuspect;
  exclude(weighed, obstacle);
  if (node.kind == CauseNode::Kind::kTrouble) weighed.candidate.remark = to_string(node.trouble);
  if (is_about_hang(causes_[weighed.failure].rule, knowledge_))
    ends(weighed, diagnosis_.may_wait_until(weighed.failure));
  if (node.kind == CauseNode::Kind::kUnsupplied)
    weighed.candidate.remark = "needs " + node.channel + ", which no node offers";
}

}  // namespace culprit::plan
