#include "plan/bayes/watchers.h"

#include <algorithm>

#include "plan/bayes/suspicion.h"

namespace culprit::plan {

Watchers::Watchers(const Knowledge& knowledge, Time until)
    : knowledge_(knowledge), places_(knowledge.graph.condensation().size()) {
  const LiveCondensation& graph = knowledge.graph.condensation();
  const RuleSet& rules = knowledge.rules;
  for (std::size_t c = 0; c < rules.components.size(); ++c) {
    if (const auto knot = knowledge.graph.knot_of(ComponentId(c))) ++places_[*knot].components;
  }
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    if (symptom_of(RuleId(r), knowledge) != Symptom::kValue ||
        !is_heard_by(until, RuleId(r), knowledge))
      continue;
    const auto level = static_cast<std::size_t>(rules.rules[r].policies.criticality);
    for (const ComponentId c : rules.rules[r].components) {
      if (const auto knot = knowledge.graph.knot_of(c)) ++places_[*knot].rules[level];
    }
  }
  for (std::size_t place = 0; place < graph.places(); ++place) {
    const LiveCondensation::Knot knot = graph.at(place);
    if (knot == LiveCondensation::kNone) continue;
    for (const LiveCondensation::Knot producer : graph.producers(knot)) {
      const Place& before = places_[producer];
      int highest = before.above;
      for (int level = 0; level < 3; ++level) {
        if (before.rules[static_cast<std::size_t>(level)] > 0) highest = std::max(highest, level);
      }
      places_[knot].above = std::max(places_[knot].above, highest);
    }
  }
}

bool Watchers::are_upstream_of(RuleId failure) const {
  const Rule& rule = knowledge_.rules[failure];
  const auto level = static_cast<std::size_t>(rule.policies.criticality);
  return std::any_of(rule.components.begin(), rule.components.end(), [&](ComponentId c) {
    const auto knot = knowledge_.graph.knot_of(c);
    if (!knot) return false;
    const Place& place = places_[*knot];
    std::size_t others = 0;
    for (std::size_t l = level; l < 3; ++l) others += place.rules[l];
    return place.above >= static_cast<int>(level) || (place.components > 1 && others > 1);
  });
}

}  // namespace culprit::plan
