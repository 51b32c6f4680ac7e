#include "diagnose/still_there.h"

#include <algorithm>
#include <cmath>

namespace culprit::diagnose {

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

}  // namespace culprit::diagnose
