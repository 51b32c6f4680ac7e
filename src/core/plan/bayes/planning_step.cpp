#include "plan/bayes/planning_step.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <tuple>

#include "plan/bayes/bayes_planner.h"
#include "plan/bayes/seen_down.h"
#include "plan/bayes/suspicion.h"
#include "plan/beside_exhausted.h"
#include "plan/ties.h"

namespace culprit::plan {
namespace {

// What costs more than it is worth has to be done all the same, once nothing else comes first: it
// is worth a little, by its index: by how likely it resolves the failure for what it costs.
std::int64_t worth(double value, double cost, double index) {
  constexpr double kLittle = 1e-4;
  return parts(std::max(value - cost, kLittle * std::min(index, 1.0))) + 1;
}

int redeployments(const Strategy& strategy) {
  return static_cast<int>(
      std::count_if(strategy.adaptations.begin(), strategy.adaptations.end(),
                    [](const Adaptation& a) { return a.type == AdaptationType::kRedeploy; }));
}

}  // namespace

PlanningStep::PlanningStep(std::span<const RuleId> failures, const Knowledge& knowledge,
                           const CostWeights& weights)
    : knowledge_(knowledge),
      weights_(weights),
      planned_(failures.begin(), failures.end()),
      suspicious_(suspicious_rules(failures, knowledge)),
      reach_(knowledge, components_of_interest(knowledge, suspicious_)),
      ways_(knowledge, reach_),
      failures_(knowledge, reach_, ways_),
      responsibility_(knowledge, failures_),
      levels_(knowledge, failures_, responsibility_),
      remedies_(all_remedies()),
      surroundings_(knowledge, reach_, levels_, worked_on(), suspicious_),
      has_choice_(failures_.size(), false),
      tries_(failures_.size()) {}

std::vector<Verdict> PlanningStep::run() {
  Time until = kLongAgo;
  for (const RuleId rule : planned_) {
    if (is_newborn(rule, knowledge_)) until = std::max(until, newborn_until(rule, knowledge_));
  }
  if (until > kLongAgo) watchers_.emplace(knowledge_, until);
  find_stakes();
  for (const RuleId rule : planned_) examine(failures_.index_of(rule));
  std::sort(entries_.begin(), entries_.end(),
            [&](const Entry& a, const Entry& b) { return is_before(a, b); });
  revive();
  for (const Criticality level :
       {Criticality::kError, Criticality::kWarning, Criticality::kNonCritical})
    select(level);
  return verdicts();
}

std::vector<std::vector<Remedy>> PlanningStep::all_remedies() const {
  std::vector<std::vector<Remedy>> all(failures_.size());
  for (const RuleId rule : planned_) all[failures_.index_of(rule)] = remedies(rule, knowledge_);
  return all;
}

// Those that something may be begun for without a person, now or later. Nobody need make way for
// the others.
std::vector<RuleId> PlanningStep::worked_on() const {
  std::vector<RuleId> rules;
  std::copy_if(planned_.begin(), planned_.end(), std::back_inserter(rules),
               [&](RuleId rule) { return !waits_for_person(failures_.index_of(rule)); });
  return rules;
}

bool PlanningStep::waits_for_person(std::size_t failure) const {
  const auto cause = cause_of(failure);
  const auto is_in_vain = [&](StrategyId id) {
    return cause && !only_revives(knowledge_.rules[id], knowledge_) &&
           !may_be_tried_beside_exhausted(id, knowledge_) && is_left_to_person(*cause);
  };
  bool is_anything_left = false;
  for (const Remedy& remedy : remedies_[failure]) {
    if (remedy.is_out()) continue;
    is_anything_left = true;
    const StrategyId id = remedy.strategy;
    const bool is_held = remedy.is_withheld && knowledge_.withheld[id.index].until == kNever;
    if (!is_held && !is_in_vain(id)) return false;
  }
  return is_anything_left;
}

// It is exhausted, or nothing may be begun for it without a person.
bool PlanningStep::is_left_to_person(RuleId rule) const {
  return knowledge_.states.awaits_person(rule) || waits_for_person(failures_.index_of(rule));
}

// The likeliest cause outside its circle, if the failure more likely has one than not; or else who
// is dead in its circle.
std::optional<RuleId> PlanningStep::cause_of(std::size_t failure) const {
  if (responsibility_.against_others(failure) >= 0.5) {
    const auto dead = responsibility_.dead_in_circle(failure);
    return dead ? std::optional(failures_[*dead]) : std::nullopt;
  }
  std::int64_t most = 0;
  RuleId cause;
  responsibility_.for_each_share(failure, [&](std::size_t j, double share) {
    if (parts(share) > most) std::tie(most, cause) = std::pair(parts(share), failures_[j]);
  });
  return cause;
}

// By level, then by worth, then by name.
bool PlanningStep::is_before(const Entry& a, const Entry& b) const {
  const auto key = [&](const Entry& e) {
    const Strategy& strategy = knowledge_.rules[e.candidate.strategy];
    const Rule& rule = knowledge_.rules[strategy.rule];
    return std::tuple<int, std::int64_t, std::int64_t, const std::string&, const std::string&>(
        -static_cast<int>(levels_.of(strategy.rule)), -e.worth, parts(e.candidate.cost), rule.name,
        strategy.name);
  };
  return key(a) < key(b);
}

void PlanningStep::find_stakes() {
  stakes_.resize(failures_.size());
  const auto weight_of = [&](std::size_t i) {
    return weight(knowledge_.rules[failures_[i]].policies.criticality);
  };
  for (std::size_t i = 0; i < failures_.size(); ++i) stakes_[i] += weight_of(i);
  // Whichever member of a circle was first, the others go away with it.
  for (const auto& circle : failures_.circles()) {
    for (const std::size_t i : circle) {
      for (const std::size_t k : circle) {
        if (k != i) stakes_[i] += responsibility_.kappa(i, k) * weight_of(k);
      }
    }
  }
  for (std::size_t k = 0; k < failures_.size(); ++k) {
    responsibility_.for_each_share(
        k, [&](std::size_t i, double share) { stakes_[i] += share * weight_of(k); });
    // What is not downstream, and was seen to go away with another one.
    for (const auto& [cause, coupling] : knowledge_.couplings.of(failures_[k])) {
      if (!knowledge_.states.is_active(cause) || coupling.cleared == 0) continue;
      const std::size_t i = failures_.index_of(cause);
      if (i != k && !has(failures_.causes(k), i))
        stakes_[i] += coupling.mean(Coupling::kRare) * weight_of(k);
    }
  }
}

void PlanningStep::examine(std::size_t failure) {
  const std::vector<Remedy>& all = remedies_[failure];
  const std::vector<Option> tries = options(failure, all);
  std::vector<std::size_t> order(all.size());  // p/c index
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const auto key = [&](std::size_t s) {
      return std::pair<std::int64_t, const std::string&>(-parts(index(tries[s])),
                                                         knowledge_.rules[all[s].strategy].name);
    };
    return key(a) < key(b);
  });
  std::vector<Option> possible;
  double helps = 0;
  for (const std::size_t s : order) {
    if (!all[s].is_out() && !all[s].is_withheld) possible.push_back(tries[s]);
    helps += all[s].chance;
  }
  const std::vector<double> costs = expected_costs(possible);
  tries_[failure] = possible;
  const double root = responsibility_.of(failure);

  std::size_t next = 0;
  for (const std::size_t s : order) {
    Entry& entry = entries_.emplace_back();
    entry.failure = failure;
    entry.candidate.strategy = all[s].strategy;
    if (all[s].is_tried) {
      entry.candidate.excluded = Condition::kTried;
    } else if (all[s].invalid) {
      exclude_invalid(entry, *all[s].invalid);
    } else if (all[s].is_withheld) {
      entry.candidate.excluded = Condition::kWithheld;
      entry.candidate.component = knowledge_.rules[all[s].strategy].components.front();
      entry.candidate.remark = knowledge_.withheld[all[s].strategy.index].reason;
    } else {
      entry.candidate.resolves = root * all[s].chance;
      entry.candidate.value = root * std::min(1.0, helps) * stakes_[failure];
      entry.candidate.cost = costs[next];
      entry.place = next++;
      entry.worth = worth(entry.candidate.value, entry.candidate.cost, root * index(tries[s]));
      exclude(entry, all[s].chance);
    }
  }
}

std::vector<Option> PlanningStep::options(std::size_t failure,
                                          const std::vector<Remedy>& remedies) const {
  const Duration latency = knowledge_.signals.latency(failures_[failure]);
  std::vector<Option> all;
  for (const Remedy& remedy : remedies) {
    const Strategy& strategy = knowledge_.rules[remedy.strategy];
    const Effort effort{strategy.impact, latency, redeployments(strategy), disruption(strategy)};
    all.push_back({remedy.chance, try_cost(effort, weights_, knowledge_.rules),
                   time_cost(effort, weights_, knowledge_.rules), remedy.luck});
  }
  return all;
}

double PlanningStep::disruption(const Strategy& strategy) const {
  std::size_t down = 0;
  for (const Adaptation& adaptation : strategy.adaptations) {
    if (takes_down(adaptation))
      down += 1 + reach_.dependents(reach_.place_of(adaptation.component));
  }
  const auto all = static_cast<double>(knowledge_.rules.components.size());
  return std::min(1.0, static_cast<double>(down) / all);
}

void PlanningStep::exclude(Entry& entry, double chance) const {
  const RuleId rule = failures_[entry.failure];
  const Strategy& strategy = knowledge_.rules[entry.candidate.strategy];
  // What is known to be dead, and a safe stop, wait for nobody but who has the component already.
  if (only_revives(strategy, knowledge_) || strategy.is_last_resort) {
    if (const auto held = surroundings_.reserved(strategy)) exclude(entry, *held);
    return;
  }
  exclude_effect(entry);
  if (entry.candidate.excluded) return;
  const bool needs_no_verdict = chance >= kSure && !takes_down(strategy);
  if (watchers_ && is_newborn(rule, knowledge_) && !needs_no_verdict &&
      watchers_->are_upstream_of(rule))
    return exclude(entry, {Condition::kSuspect, likeliest_component(rule), rule});
  if (const auto held = surroundings_.reserved(strategy)) return exclude(entry, *held);
  for (const ComponentId c : strategy.components) {
    if (const auto obstacle = surroundings_.obstacle(reach_.place_of(c), strategy, chance))
      return exclude(entry, *obstacle);
  }
  const auto& settling = knowledge_.states[rule].settling;
  const bool is_settling =
      settling && knowledge_.now < settling->until &&
      !knowledge_.signals.is_read_since(rule, settling->since) &&
      knowledge_.couplings.of(settling->with, rule).mean(Coupling::kUsual) > 0.5;
  if (is_settling)
    return exclude(entry,
                   {Condition::kSettling, likeliest_component(settling->with), settling->with});
}

void PlanningStep::exclude(Entry& entry, const Surroundings::Obstacle& obstacle) const {
  entry.candidate.excluded = obstacle.condition;
  entry.candidate.component = obstacle.component;
  entry.candidate.failure = obstacle.because;
}

// What makes no sense now may make sense once that is over which is being done to its component.
void PlanningStep::exclude_invalid(Entry& entry, const Invalid& why) const {
  const Strategy& strategy = knowledge_.rules[entry.candidate.strategy];
  if (const auto held = surroundings_.reserved(strategy)) return exclude(entry, *held);
  entry.candidate.excluded = Condition::kInvalid;
  entry.candidate.component = why.component;
  entry.candidate.remark = why.reason;
}

// A failure that others more likely explain waits for them.
void PlanningStep::exclude_effect(Entry& entry) const {
  if (const auto cause = cause_of(entry.failure)) {
    const bool goes_round = may_be_tried_beside_exhausted(entry.candidate.strategy, knowledge_) &&
                            is_left_to_person(*cause);
    if (!goes_round) exclude(entry, {Condition::kDependency, likeliest_component(*cause), *cause});
    return;
  }
  // In a circle the members take turns, whoever is the likelier: what counts is what is outside.
  // But who is in a circle is only known when the failures are old enough.
  if (!is_young(failures_[entry.failure], knowledge_)) return;
  std::int64_t most = 0;
  RuleId likeliest;
  for (const std::size_t j : failures_.circles()[failures_.circle_of(entry.failure)]) {
    if (j != entry.failure && parts(responsibility_.of(j)) > most)
      std::tie(most, likeliest) = std::pair(parts(responsibility_.of(j)), failures_[j]);
  }
  if (most > 0) exclude(entry, {Condition::kDependency, likeliest_component(likeliest), likeliest});
}

// The dead are replaced side by side, whatever depends on whatever and however critical it is.
void PlanningStep::revive() {
  for (Entry& entry : entries_) {
    const Strategy& strategy = knowledge_.rules[entry.candidate.strategy];
    if (entry.candidate.excluded || !only_revives(strategy, knowledge_)) continue;
    if (has_choice_[entry.failure]) {
      entry.candidate.excluded = Condition::kOneEach;
      continue;
    }
    for (const ComponentId c : strategy.components) {
      if (const auto taken = surroundings_.taken(reach_.place_of(c))) exclude(entry, *taken);
    }
    if (!entry.candidate.excluded) choose(entry);
  }
}

void PlanningStep::choose(const Entry& entry) {
  has_choice_[entry.failure] = true;
  sides_.push_back({tries_[entry.failure], {entry.place}});
  surroundings_.add(knowledge_.rules[entry.candidate.strategy]);
}

// Does what was chosen before stand against it? Then it is excluded.
bool PlanningStep::is_taken(Entry& entry) const {
  if (has_choice_[entry.failure]) {
    entry.candidate.excluded = Condition::kOneEach;
    return true;
  }
  for (const ComponentId c : knowledge_.rules[entry.candidate.strategy].components) {
    const auto conflict = surroundings_.conflict(reach_.place_of(c));
    if (!conflict) continue;
    exclude(entry, *conflict);
    return true;
  }
  return false;
}

void PlanningStep::select(Criticality level) {
  std::vector<Entry*> open;
  for (Entry& entry : entries_) {
    const Strategy& strategy = knowledge_.rules[entry.candidate.strategy];
    const bool is_next = !entry.candidate.excluded && levels_.of(strategy.rule) == level &&
                         !only_revives(strategy, knowledge_);
    if (is_next && !is_taken(entry)) open.push_back(&entry);
  }

  const std::vector<Entry*> chosen = weigh_together(open, chosen_together(open));
  for (const Entry* entry : chosen) choose(*entry);
  for (Entry* entry : open) {
    if (std::find(chosen.begin(), chosen.end(), entry) == chosen.end()) is_taken(*entry);
  }
}

// The conflict-free ones of the highest total worth.
std::vector<PlanningStep::Entry*> PlanningStep::chosen_together(
    const std::vector<Entry*>& open) const {
  BitRows takes(open.size(), reach_.size());
  BitRows near(open.size(), reach_.size());
  std::vector<Choice> choices;
  for (std::size_t e = 0; e < open.size(); ++e) {
    for (const ComponentId c : knowledge_.rules[open[e]->candidate.strategy].components) {
      const std::size_t place = reach_.place_of(c);
      set(takes[e], place);
      add(near[e], reach_.upstream(place));
      add(near[e], reach_.downstream(place));
    }
    add(near[e], takes[e]);
    choices.push_back({open[e]->failure, open[e]->worth, takes[e], near[e]});
  }
  std::vector<Entry*> chosen;
  for (const std::size_t e : best_conflict_free_set(choices)) chosen.push_back(open[e]);
  return chosen;
}

// Of the same failures, at the same components, what costs the least beside each other.
std::vector<PlanningStep::Entry*> PlanningStep::weigh_together(
    const std::vector<Entry*>& open, const std::vector<Entry*>& chosen) const {
  std::vector<Side> sides = sides_;
  std::vector<std::vector<Entry*>> firsts;
  for (Entry* usual : chosen) {
    auto& all = firsts.emplace_back(1, usual);
    const auto& components = knowledge_.rules[usual->candidate.strategy].components;
    std::copy_if(open.begin(), open.end(), std::back_inserter(all), [&](const Entry* other) {
      return other != usual && other->failure == usual->failure &&
             knowledge_.rules[other->candidate.strategy].components == components;
    });
    Side& side = sides.emplace_back(Side{tries_[usual->failure], {}});
    for (const Entry* entry : all) side.firsts.push_back(entry->place);
  }
  const std::vector<std::size_t> begins = side_by_side(sides);
  std::vector<Entry*> together;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const std::size_t place = begins[sides_.size() + i];
    together.push_back(*std::find_if(firsts[i].begin(), firsts[i].end(),
                                     [&](const Entry* entry) { return entry->place == place; }));
  }
  return together;
}

// Of the components that the rule's strategies adapt, the one that the untried ones are most likely
// to help at.
ComponentId PlanningStep::likeliest_component(RuleId rule) const {
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

std::vector<Suspect> PlanningStep::suspects(std::size_t failure) const {
  std::vector<Suspect> all;
  const RuleId rule = failures_[failure];
  all.push_back({{}, rule, responsibility_.of(failure)});
  responsibility_.for_each_share(failure, [&](std::size_t j, double share) {
    all.push_back({{}, failures_[j], share});
  });
  const std::size_t shown = std::min(all.size(), BayesPlanner::kSuspects);
  std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(shown), all.end(),
                    [&](const Suspect& a, const Suspect& b) {
                      const auto key = [&](const Suspect& s) {
                        return std::pair<std::int64_t, const std::string&>(
                            -parts(s.probability), knowledge_.rules[s.failure].name);
                      };
                      return key(a) < key(b);
                    });
  all.resize(shown);
  for (Suspect& suspect : all) suspect.component = likeliest_component(suspect.failure);
  return all;
}

std::vector<Verdict> PlanningStep::verdicts() {
  std::vector<Verdict> found;
  std::vector<std::size_t> place(failures_.size(), failures_.size());
  for (Entry& entry : entries_) {
    std::size_t& at = place[entry.failure];
    if (at == failures_.size()) {
      at = found.size();
      found.push_back({failures_[entry.failure], {}, true, {}, suspects(entry.failure)});
    }
    Verdict& verdict = found[at];
    const auto& excluded = entry.candidate.excluded;
    if (!excluded) verdict.chosen = entry.candidate.strategy;
    verdict.is_spent &= excluded == Condition::kTried || excluded == Condition::kInvalid;
    verdict.candidates.push_back(std::move(entry.candidate));
  }
  return found;
}

}  // namespace culprit::plan
