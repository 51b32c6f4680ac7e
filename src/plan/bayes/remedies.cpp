#include "plan/bayes/remedies.h"

#include <algorithm>

#include "plan/bayes/seen_down.h"

namespace culprit::plan {
std::vector<Remedy> remedies(RuleId rule, const Knowledge& knowledge) {
  const auto& strategies = knowledge.rules[rule].strategies;
  const RuleState& state = knowledge.states[rule];
  const bool is_down = is_seen_down(rule, knowledge);
  std::vector<Remedy> all;
  double out = 0;
  for (std::size_t s = 0; s < strategies.size(); ++s) {
    const Strategy& strategy = knowledge.rules[strategies[s]];
    Remedy remedy{strategies[s], state.tried[s], {}, knowledge.beliefs[strategies[s]].mean().value};
    if (is_down && !revives(strategy, knowledge)) remedy.chance *= kUnlikely;
    if (!remedy.is_tried) remedy.invalid = invalidity(strategy, knowledge);
    remedy.is_withheld =
        !remedy.is_out() && !knowledge.withheld[strategies[s].index].reason.empty();
    if (remedy.is_out()) out += std::exchange(remedy.chance, 0);
    all.push_back(std::move(remedy));
  }
  for (Remedy& remedy : all) {
    if (remedy.chance > 0) remedy.chance /= std::max(remedy.chance, 1 - out);
  }
  return all;
}

}  // namespace culprit::plan
