#include "plan/bayes/strategy_chances.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "plan/bayes/seen_down.h"

namespace culprit::plan {
namespace {

// q of a strategy that helps with `chance` and is for `own` of what may be wrong.
double luck_of(double chance, double own) { return own < 1 ? (chance - own) / (1 - own) : 0; }

}  // namespace

std::vector<StrategyChance> strategy_chances(RuleId rule, const Knowledge& knowledge) {
  const auto& strategies = knowledge.rules[rule].strategies;
  const RuleState& state = knowledge.states[rule];
  const bool is_down = is_seen_down(rule, knowledge);
  std::vector<StrategyChance> all;
  all.reserve(strategies.size());
  double sum = 0;
  for (std::size_t s = 0; s < strategies.size(); ++s) {
    const Strategy& strategy = knowledge.rules[strategies[s]];
    StrategyChance each{
        strategies[s], state.search.tried[s], {}, knowledge.beliefs[strategies[s]].mean().value};
    if (is_down && !revives(strategy, knowledge)) each.chance *= kUnlikely;
    if (!each.is_tried) each.invalid = invalidity(strategy, knowledge);
    each.is_withheld = !each.is_out() && !knowledge.withheld[strategies[s].index].reason.empty();
    sum += each.chance;
    all.push_back(std::move(each));
  }
  const double causes = std::max(1.0, sum);
  double left = 1;
  for (const StrategyChance& each : all) {
    // What nobody can do now is not ruled out by that.
    const bool is_ruled_out = each.is_out() && !each.is_unheard();
    if (is_ruled_out) left -= each.chance / causes;
  }
  for (StrategyChance& each : all) {
    const double own = each.chance / causes;
    each.luck = luck_of(std::exchange(each.chance, 0), own);
    if (each.is_out() || own == 0) continue;
    const double now = own / std::max(own, left);
    each.chance = now + (1 - now) * each.luck;
  }
  return all;
}

double still_there(RuleId rule, const Knowledge& knowledge) {
  const auto& strategies = knowledge.rules[rule].strategies;
  const RuleState& state = knowledge.states[rule];
  double sum = 0;
  for (const StrategyId s : strategies) sum += knowledge.beliefs[s].mean().value;
  double left = 1;
  double unlucky = 1;
  double turn = 1;
  for (std::size_t s = 0; s < strategies.size(); ++s) {
    const double chance = knowledge.beliefs[strategies[s]].mean().value;
    const double own = chance / std::max(1.0, sum);
    turn *= 1 - chance;
    if (!state.search.tried[s]) continue;
    left -= own;
    unlucky *= 1 - luck_of(chance, own);
  }
  return std::max(0.0, left) * unlucky * std::pow(turn, state.search.round);
}

}  // namespace culprit::plan
