#include "plan/bayes/levels.h"

#include <algorithm>

namespace culprit::plan {

Levels::Levels(const Knowledge& knowledge, const Failures& failures,
               const Responsibility& responsibility)
    : knowledge_(knowledge), failures_(failures) {
  for (std::size_t i = 0; i < failures.size(); ++i)
    levels_.push_back(knowledge.rules[failures[i]].policies.criticality);
  for (bool is_more = true; is_more;) {
    is_more = false;
    const auto raise = [&](std::size_t i, Criticality level) {
      is_more |= levels_[i] < level;
      levels_[i] = std::max(levels_[i], level);
    };
    for (std::size_t k = 0; k < failures.size(); ++k) {
      for_each(failures.causes(k), [&](std::size_t i) {
        if (responsibility.is_explained_by(k, i)) raise(i, levels_[k]);
      });
      for (const std::size_t i : failures.circles()[failures.circle_of(k)]) raise(i, levels_[k]);
    }
  }
}

Criticality Levels::of(RuleId rule) const {
  if (!failures_.holds(rule)) return knowledge_.rules[rule].policies.criticality;
  return levels_[failures_.index_of(rule)];
}

}  // namespace culprit::plan
