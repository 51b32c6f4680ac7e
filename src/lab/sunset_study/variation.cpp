#include "sunset_study/variation.h"

#include <algorithm>
#include <cmath>

#include "knowledge/ambiguity.h"

namespace culprit::study {

sunset::model::Profile varied(sunset::model::Profile profile, const Variation& variation) {
  if (variation.relaunch) profile.start.least = *variation.relaunch;
  if (variation.blackboard_period) profile.blackboard_period = *variation.blackboard_period;
  if (variation.window) profile.frequency_window = *variation.window;
  return profile;
}

RuleSet varied(RuleSet rules, const Variation& variation) {
  if (variation.patience == 1) return rules;
  rules.heaviest = {};
  for (Strategy& strategy : rules.strategies) {
    if (begins_anew(strategy)) {
      const double scaled = static_cast<double>(strategy.impact.count) * variation.patience;
      strategy.impact = Cycles{std::max<std::int64_t>(1, std::llround(scaled))};
    }
    rules.heaviest = std::max(rules.heaviest, strategy.impact);
  }
  return rules;
}

}  // namespace culprit::study
