#include "plan/bayes/strategy_chances.h"

#include <algorithm>
#include <utility>

#include "diagnose/known_down.h"
#include "diagnose/still_there.h"

namespace culprit::plan {
std::vector<StrategyChance> strategy_chances(RuleId rule, const Knowledge& knowledge) {
  const auto& strategies = knowledge.rules[rule].strategies;
  const RuleState& state = knowledge.states[rule];
  const bool is_down = diagnose::is_known_down(rule, knowledge);
  std::vector<StrategyChance> all;
  all.reserve(strategies.size());
  double sum = 0;
  for (std::size_t s = 0; s < strategies.size(); ++s) {
    const Strategy& strategy = knowledge.rules[strategies[s]];
    StrategyChance each{
        strategies[s], state.search.tried[s], {}, knowledge.beliefs[strategies[s]].mean().value};
    if (is_down && !diagnose::revives(strategy, knowledge)) each.chance *= kUnlikely;
    if (!each.is_tried) each.invalid = invalidity(strategy, knowledge);
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
