#include "plan/bayes/levels.h"

#include <algorithm>

namespace culprit::plan {

Levels::Levels(const Knowledge& knowledge, const diagnose::Causes& causes,
               const diagnose::Diagnosis& diagnosis)
    : knowledge_(knowledge), causes_(causes), levels_(causes.size(), Criticality::kNonCritical) {
  for (std::size_t i = 0; i < causes.size(); ++i) {
    if (causes[i].is_rule()) levels_[i] = knowledge.rules[causes[i].rule].policies.criticality;
  }
  for (bool is_more = true; is_more;) {
    is_more = false;
    const auto raise = [&](std::size_t i, Criticality level) {
      is_more |= levels_[i] < level;
      levels_[i] = std::max(levels_[i], level);
    };
    for (std::size_t k = 0; k < causes.size(); ++k) {
      diagnose::for_each(causes.causes(k), [&](std::size_t i) {
        if (diagnosis.is_explained_by(k, i)) raise(i, levels_[k]);
      });
      for (const std::size_t i : causes.loops()[causes.loop_of(k)]) raise(i, levels_[k]);
    }
  }
}

Criticality Levels::of(RuleId rule) const {
  if (!causes_.holds(rule)) return knowledge_.rules[rule].policies.criticality;
  return levels_[causes_.index_of(rule)];
}

}  // namespace culprit::plan
