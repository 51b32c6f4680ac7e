#include "plan/bayes/strategy_chances.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "diagnose/causes.h"
#include "diagnose/known_down.h"
#include "diagnose/still_there.h"
#include "plan/bayes/exclusions.h"

namespace culprit::plan {
namespace {

using diagnose::Trouble;
using diagnose::TroubleSeen;

// In a trouble that began with the failure, or shortly before it? One that was there for long is no reason for it. A
// lifecycle is none: a process that begins anew is brought to the state where it was.
bool is_ill(const std::optional<TroubleSeen>& trouble, const Onset& failure) {
  if (!trouble || trouble->trouble == Trouble::kNeverSeen) return false;
  const bool is_of_process =
      diagnose::answers_nothing(trouble->trouble) || trouble->trouble == Trouble::kSilent;
  return is_of_process && trouble->onset.earliest <= failure.latest &&
         failure.earliest <= later(trouble->onset.latest, diagnose::kUsualDelay);
}

bool mends(const Strategy& strategy, ComponentId component) {
  return std::ranges::any_of(strategy.adaptations, [&](const Adaptation& a) {
    return a.component == component &&
           (a.type == AdaptationType::kRestart || a.type == AdaptationType::kCall || launches(a));
  });
}

bool is_upstream(ComponentId component, ComponentId of, const Knowledge& knowledge) {
  const auto& upstream = knowledge.graph.upstream(of);
  return component != of && std::ranges::find(upstream, component) != upstream.end();
}

// Those of the components that the rule mends in which its failure evidently began: they are in trouble. One that is only
// silent counts if another silent one depends on it.
std::vector<ComponentId> evidently_ill(RuleId rule, Troubles troubles, const Knowledge& knowledge) {
  const Onset onset = diagnose::onset_of(rule, knowledge);
  std::vector<ComponentId> ill;
  std::vector<ComponentId> silent;
  for (const ComponentId c : knowledge.rules[rule].repaired) {
    const bool is_mended = std::ranges::any_of(
        knowledge.rules[rule].strategies,
        [&](StrategyId strategy) { return mends(knowledge.rules[strategy], c); });
    if (!is_mended || !is_ill(troubles[c.index], onset)) continue;
    (troubles[c.index]->trouble == Trouble::kSilent ? silent : ill).push_back(c);
  }
  if (!ill.empty()) return ill;
  std::ranges::copy_if(silent, std::back_inserter(ill), [&](ComponentId c) {
    return std::ranges::any_of(silent,
                               [&](ComponentId other) { return is_upstream(c, other, knowledge); });
  });
  return ill;
}

// It would end what works, and leave a supplier down that another strategy of its rule replaces.
std::optional<Invalid> lacks_supplier(const Strategy& strategy, const std::vector<ComponentId>& ill,
                                      Troubles troubles, const Knowledge& knowledge) {
  const auto works = [&](ComponentId c) {
    const auto& trouble = troubles[c.index];
    return !trouble || trouble->trouble == Trouble::kSilent;
  };
  const auto needs = [&](const Adaptation& a, ComponentId supplier) {
    return !takes_down(a) || (works(a.component) && is_upstream(supplier, a.component, knowledge));
  };
  for (const ComponentId c : ill) {
    const bool is_in_vain =
        takes_down(strategy) && diagnose::answers_nothing(troubles[c.index]->trouble) &&
        std::ranges::all_of(strategy.adaptations, [&](const Adaptation& a) { return needs(a, c); });
    if (!is_in_vain) continue;
    const std::string& supplier = knowledge.rules[c].name;
    return Invalid{c, "ends what needs " + supplier + ", and " + supplier + " " +
                          std::string(to_string(troubles[c.index]->trouble))};
  }
  return std::nullopt;
}

}  // namespace

std::vector<StrategyChance> strategy_chances(RuleId rule, Troubles troubles,
                                             const Knowledge& knowledge) {
  const auto& strategies = knowledge.rules[rule].strategies;
  const RuleState& state = knowledge.states[rule];
  const bool is_down = diagnose::is_known_down(rule, knowledge);
  const std::vector<ComponentId> ill = evidently_ill(rule, troubles, knowledge);
  const auto leaves_it_ill = [&](const Strategy& strategy) {
    if (is_down) return !diagnose::revives(strategy, knowledge);
    return !ill.empty() &&
           std::ranges::none_of(ill, [&](ComponentId c) { return mends(strategy, c); });
  };
  std::vector<StrategyChance> all;
  all.reserve(strategies.size());
  double sum = 0;
  for (std::size_t s = 0; s < strategies.size(); ++s) {
    const Strategy& strategy = knowledge.rules[strategies[s]];
    StrategyChance each{
        strategies[s], state.search.tried[s], {}, knowledge.beliefs[strategies[s]].mean().value};
    each.leaves_ill = leaves_it_ill(strategy);
    if (each.leaves_ill) each.chance *= kUnlikely;
    if (!each.is_tried) each.invalid = invalidity(strategy, knowledge);
    if (!each.is_out() && each.leaves_ill)
      each.invalid = lacks_supplier(strategy, ill, troubles, knowledge);
    each.is_withheld = !each.is_out() && !knowledge.withheld[strategies[s].index].reason.empty();
    sum += each.chance;
    all.push_back(std::move(each));
  }
  const double causes = std::max(1.0, sum);
  double left = 1;
  for (const StrategyChance& each : all) {
    // A strategy that cannot be carried out now is not ruled out by that.
    const bool is_ruled_out = each.is_out() && !each.is_unheard();
    if (is_ruled_out) left -= each.chance / causes;
  }
  for (StrategyChance& each : all) {
    const double own = each.chance / causes;
    each.luck = diagnose::luck_of(std::exchange(each.chance, 0), own);
    if (each.is_out() || own == 0) continue;
    const double now = own / std::max(own, left);
    each.chance = now + (1 - now) * each.luck;
  }
  return all;
}

}  // namespace culprit::plan
