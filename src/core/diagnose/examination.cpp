#include "diagnose/examination.h"

#include <algorithm>

#include "diagnose/imminent.h"
#include "diagnose/touched.h"

namespace culprit::diagnose {
namespace {

std::vector<ComponentId> components_that_matter(
    const Knowledge& knowledge, std::span<const RuleId> imminent,
    std::span<const std::optional<TroubleSeen>> troubles) {
  std::vector<ComponentId> all;
  const auto add = [&](RuleId rule) {
    for (const ComponentId c : knowledge.rules[rule].components) {
      const auto& others = knowledge.components[c].ends_with;
      all.push_back(c);
      all.insert(all.end(), others.begin(), others.end());
    }
    for (const auto& those : {spreads_from(rule, knowledge), watched_beside(rule, knowledge)})
      all.insert(all.end(), those.begin(), those.end());
  };
  std::for_each(knowledge.states.active().begin(), knowledge.states.active().end(), add);
  std::for_each(knowledge.states.exhausted().begin(), knowledge.states.exhausted().end(), add);
  std::for_each(imminent.begin(), imminent.end(), add);
  Time oldest = kNever;
  for (const RuleId rule : knowledge.states.active())
    oldest = std::min(oldest, onset_of(rule, knowledge).earliest);
  for (std::size_t c = 0; c < troubles.size(); ++c) {
    const auto& past = knowledge.components[ComponentId(c)].past_trouble;
    const bool may_have_led_to_one = past && past->over >= oldest;
    if (troubles[c] || may_have_led_to_one || knowledge.is_unheard(ComponentId(c)))
      all.emplace_back(c);
  }
  return all;
}

}  // namespace

Examination::Examination(const Knowledge& knowledge, std::span<const RuleId> failures)
    : imminent_(imminent_rules(knowledge)),
      troubles_(all_troubles(knowledge)),
      awaited_(knowledge, failures),
      reach_(knowledge, components_that_matter(knowledge, imminent_, troubles_)),
      paths_(knowledge, reach_, awaited_, imminent_, troubles_),
      causes_(knowledge, reach_, paths_, imminent_, troubles_),
      diagnosis_(knowledge, causes_) {}

}  // namespace culprit::diagnose
