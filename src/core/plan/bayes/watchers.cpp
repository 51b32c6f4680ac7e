#include "plan/bayes/watchers.h"

#include <algorithm>

#include "plan/bayes/suspicion.h"

namespace culprit::plan {

Watchers::Watchers(const Knowledge& knowledge, Time until)
    : knowledge_(knowledge), places_(knowledge.graph.condensation().size()) {
  const Condensation& graph = knowledge.graph.condensation();
  const RuleSet& rules = knowledge.rules;
  for (std::size_t c = 0; c < rules.components.size(); ++c) {
    if (const auto scc = knowledge.graph.scc_of(ComponentId(c))) ++places_[*scc].components;
  }
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    if (symptom_of(RuleId(r), knowledge) != Symptom::kValue ||
        !is_heard_by(until, RuleId(r), knowledge))
      continue;
    for (const ComponentId c : rules.rules[r].components) {
      if (const auto scc = knowledge.graph.scc_of(c)) ++places_[*scc].rules;
    }
  }
  for (Condensation::Scc scc = 0; scc < graph.size(); ++scc) {
    for (const Condensation::Scc producer : graph.producers(scc)) {
      const Place& before = places_[producer];
      places_[scc].is_below_one |= before.is_below_one || before.rules > 0;
    }
  }
}

bool Watchers::are_upstream_of(RuleId failure) const {
  const Rule& rule = knowledge_.rules[failure];
  return std::any_of(rule.components.begin(), rule.components.end(), [&](ComponentId c) {
    const auto scc = knowledge_.graph.scc_of(c);
    if (!scc) return false;
    const Place& place = places_[*scc];
    return place.is_below_one || (place.components > 1 && place.rules > 1);
  });
}

}  // namespace culprit::plan
