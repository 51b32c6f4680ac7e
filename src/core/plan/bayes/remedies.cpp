#include "plan/bayes/remedies.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "plan/bayes/seen_down.h"

namespace culprit::plan {
namespace {

// q of a strategy that helps with `chance` and is for `own` of what may be wrong.
double luck_of(double chance, double own) { return own < 1 ? (chance - own) / (1 - own) : 0; }

}  // namespace

std::vector<Remedy> remedies(RuleId rule, const Knowledge& knowledge) {
  const auto& strategies = knowledge.rules[rule].strategies;
  const RuleState& state = knowledge.states[rule];
  const bool is_down = is_seen_down(rule, knowledge);
  std::vector<Remedy> all;
  double sum = 0;
  for (std::size_t s = 0; s < strategies.size(); ++s) {
    const Strategy& strategy = knowledge.rules[strategies[s]];
    Remedy remedy{
        strategies[s], state.search.tried[s], {}, knowledge.beliefs[strategies[s]].mean().value};
    if (is_down && !revives(strategy, knowledge)) remedy.chance *= kUnlikely;
    if (!remedy.is_tried) remedy.invalid = invalidity(strategy, knowledge);
    remedy.is_withheld =
        !remedy.is_out() && !knowledge.withheld[strategies[s].index].reason.empty();
    sum += remedy.chance;
    all.push_back(std::move(remedy));
  }
  const double causes = std::max(1.0, sum);
  double left = 1;
  for (const Remedy& remedy : all) {
    if (remedy.is_out()) left -= remedy.chance / causes;
  }
  for (Remedy& remedy : all) {
    const double own = remedy.chance / causes;
    remedy.luck = luck_of(std::exchange(remedy.chance, 0), own);
    if (remedy.is_out() || own == 0) continue;
    const double now = own / std::max(own, left);
    remedy.chance = now + (1 - now) * remedy.luck;
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
