#include "plan/bayes/planning_step.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <tuple>

#include "base/invariant.h"
#include "diagnose/touched.h"
#include "plan/also_ended.h"
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

// The components of which a node has to answer, so that the strategy can be carried out.
std::vector<ComponentId> sends_requests_to(const Strategy& strategy) {
  std::vector<ComponentId> found;
  for (const Adaptation& a : strategy.adaptations) {
    const bool is_request =
        syntax::names_parameter(a.type) || a.type == AdaptationType::kActivate ||
        a.type == AdaptationType::kDeactivate || a.type == AdaptationType::kRestart;
    if (is_request && std::ranges::find(found, a.component) == found.end())
      found.push_back(a.component);
  }
  return found;
}

// Are its adaptations those of the other one? Values of parameters are not compared.
bool does_the_same(const Strategy& a, const Strategy& b) {
  const auto is_same = [](const Adaptation& one, const Adaptation& other) {
    return one.component == other.component && one.type == other.type &&
           one.subject == other.subject && one.topic == other.topic &&
           one.request == other.request && !syntax::names_parameter(one.type);
  };
  return std::ranges::equal(a.adaptations, b.adaptations, is_same);
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
      likely_(knowledge, found_, planned_),
      levels_(knowledge, causes_, diagnosis_),
      exclusions_(knowledge, found_, levels_, worked_on()),
      reasons_(knowledge, weights, found_, likely_, exclusions_),
      questioner_(knowledge, found_.troubles()),
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
  ask_suspects();
  ask_again();
  return decisions();
}

// The failures for which a strategy may begin without a person, now or once what is under way is over. No failure need
// make way for the others: what another one does may be what makes a strategy possible.
std::vector<RuleId> PlanningStep::worked_on() const {
  const auto may_begin = [&](const StrategyChance& each) {
    const bool is_under_way =
        each.invalid && knowledge_.states.reservation(each.invalid->component) != nullptr;
    return !each.is_out() || is_under_way;
  };
  std::vector<RuleId> rules;
  std::copy_if(planned_.begin(), planned_.end(), std::back_inserter(rules), [&](RuleId rule) {
    const std::size_t failure = causes_.index_of(rule);
    return std::ranges::any_of(likely_.chances(failure), may_begin) &&
           !likely_.waits_for_person(failure);
  });
  return rules;
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
  for (const RuleId rule : planned_) count += likely_.chances(causes_.index_of(rule)).size();
  weighed_.reserve(count);
  for (const RuleId rule : planned_) examine(causes_.index_of(rule));
  best_first_.reserve(count);
  for (WeighedCandidate& weighed : weighed_) best_first_.push_back(&weighed);
  std::sort(
      best_first_.begin(), best_first_.end(),
      [&](const WeighedCandidate* a, const WeighedCandidate* b) { return is_before(*a, *b); });
}

void PlanningStep::examine(std::size_t failure) {
  const std::vector<StrategyChance>& all = likely_.chances(failure);
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
      reasons_.look_at(weighed, *all[s].invalid);
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
      reasons_.look_at(weighed, all[s].chance);
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

// Before something is taken down or called, those upstream that may hang are asked. It goes on waiting in the
// place that it was chosen for: nothing that it stands against is begun meanwhile.
void PlanningStep::await_answers() {
  for (WeighedCandidate* weighed : best_first_) {
    const Strategy& strategy = knowledge_.rules[weighed->candidate.strategy];
    const bool has_to_wait = !weighed->candidate.excluded && !weighed->only_revives &&
                             (takes_down(strategy) || diagnose::mends(strategy));
    if (!has_to_wait) continue;
    Questions questions = questioner_.about(strategy);
    asks_[weighed->failure] = std::move(questions.asks);
    if (questions.lost) {
      exclude(*weighed, {Condition::kDependency, questions.lost->publisher, {}});
      weighed->candidate.remark = diagnose::in_words(*questions.lost, knowledge_);
    }
    if (questions.awaited) await(*questions.awaited, *weighed);
  }
}

// Those that its requests go to are asked, too, also while it waits for something else: once it is known that they
// do not answer, no time is lost by requests.
void PlanningStep::ask_suspects() {
  for (WeighedCandidate* weighed : best_first_) {
    const auto& excluded = weighed->candidate.excluded;
    const bool may_begin =
        !excluded || excluded == Condition::kSuspect || excluded == Condition::kSettling;
    if (!may_begin || weighed->only_revives || likely_.of(weighed->failure)) continue;
    const std::vector<ComponentId> requested =
        sends_requests_to(knowledge_.rules[weighed->candidate.strategy]);
    const Questions questions = questioner_.to(requested, causes_[weighed->failure].rule);
    std::vector<ComponentId>& asks = asks_[weighed->failure];
    std::ranges::copy_if(questions.asks, std::back_inserter(asks),
                         [&](ComponentId c) { return std::ranges::find(asks, c) == asks.end(); });
    if (questions.awaited && !excluded) await(*questions.awaited, *weighed);
  }
}

// It waits for the answer of the component to a question.
void PlanningStep::await(ComponentId component, WeighedCandidate& weighed) const {
  exclude(weighed, {Condition::kSuspect, component, {}});
  weighed.candidate.remark = "asked whether it answers";
  // One that never answered is not taken to hang.
  const ComponentState& asked = knowledge_.components[component];
  if (!asked.answers_probes) return;
  const std::vector<ComponentId>& asks = asks_[weighed.failure];
  const bool is_open = asked.questioned.is_open && std::ranges::find(asks, component) == asks.end();
  const Time since = is_open ? asked.questioned.at : knowledge_.now;
  weighed.candidate.within = later(since, kLongestQuestion) - knowledge_.now;
}

// While one that did not answer explains a failure, or whose values have stopped, it is asked again: it may only have been
// busy, or have nothing to tell.
void PlanningStep::ask_again() {
  for (const RuleId rule : planned_) {
    const std::size_t failure = causes_.index_of(rule);
    const auto cause = likely_.of(failure);
    if (has_choice_[failure] || !cause || causes_[*cause].kind != CauseNode::Kind::kTrouble)
      continue;
    const ComponentId component = causes_[*cause].component;
    if (is_to_be_asked(component, *found_.troubles()[component.index], knowledge_))
      asks_[failure].push_back(component);
  }
}

void PlanningStep::choose(const WeighedCandidate& weighed) {
  CULPRIT_ASSERT(!weighed.candidate.excluded);
  CULPRIT_ASSERT(!has_choice_[weighed.failure]);  // two strategies for one failure
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
  for (WeighedCandidate* weighed : chosen) {
    if (const auto other = done_for_another(*weighed, chosen))
      leave_to(knowledge_.rules[*other].rule, weighed->failure, open);
    else
      choose(*weighed);
  }
  for (WeighedCandidate* weighed : open) {
    const bool is_chosen = std::find(chosen.begin(), chosen.end(), weighed) != chosen.end();
    if (!is_chosen && !weighed->candidate.excluded) is_taken(*weighed);
  }
}

// The strategy of the other rule may clear `failure`: it waits for that.
void PlanningStep::leave_to(RuleId other, std::size_t failure,
                            const std::vector<WeighedCandidate*>& open) const {
  for (WeighedCandidate* weighed : open) {
    if (weighed->failure == failure)
      exclude(*weighed, {Condition::kSettling, likely_.likeliest_component(other), other});
  }
}

// The strategy of another failure, under way or of those chosen with it, that does what another
// strategy of this failure would do: it may clear both. A less critical one is not waited for: it may take long.
std::optional<StrategyId> PlanningStep::done_for_another(
    const WeighedCandidate& weighed, const std::vector<WeighedCandidate*>& chosen) const {
  const auto would_do = [&](StrategyId other) {
    const auto& chances = likely_.chances(weighed.failure);
    return std::ranges::any_of(chances, [&](const StrategyChance& own) {
      return !own.is_out() && own.strategy != weighed.candidate.strategy &&
             does_the_same(knowledge_.rules[own.strategy], knowledge_.rules[other]);
    });
  };
  for (const WeighedCandidate* other : chosen) {
    const bool begins = other != &weighed && !other->candidate.excluded;
    if (begins && would_do(other->candidate.strategy)) return other->candidate.strategy;
  }
  for (const RuleId id : knowledge_.states.active()) {
    const auto& attempt = knowledge_.states[id].attempt;
    if (attempt && levels_.of(id) >= weighed.level && would_do(attempt->strategy))
      return attempt->strategy;
  }
  return std::nullopt;
}

// The conflict-free ones of the highest total worth.
std::vector<WeighedCandidate*> PlanningStep::chosen_together(
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
std::vector<WeighedCandidate*> PlanningStep::weigh_together(
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
    const auto first =
        std::find_if(firsts[i].begin(), firsts[i].end(),
                     [&](const WeighedCandidate* weighed) { return weighed->place == place; });
    CULPRIT_ASSERT(first != firsts[i].end());
    together.push_back(*first);
  }
  return together;
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
                       likely_.suspects(weighed->failure),
                       std::move(asks_[weighed->failure])});
      found.back().candidates.reserve(likely_.chances(weighed->failure).size());
    }
    Decision& decision = found[at];
    const auto& excluded = weighed->candidate.excluded;
    // One of another failure would be begun for it.
    CULPRIT_ASSERT(knowledge_.rules[weighed->candidate.strategy].rule == decision.rule);
    if (!excluded) decision.chosen = weighed->candidate.strategy;
    decision.is_spent &= excluded == Condition::kTried || excluded == Condition::kInvalid;
    decision.candidates.push_back(std::move(weighed->candidate));
  }
  return found;
}

}  // namespace culprit::plan
