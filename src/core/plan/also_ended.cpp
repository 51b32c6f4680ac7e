#include "plan/also_ended.h"

#include <algorithm>

namespace culprit::plan {

std::vector<ComponentId> also_ended(const Strategy& strategy, const Knowledge& knowledge) {
  std::vector<ComponentId> all;
  for (const Adaptation& adaptation : strategy.adaptations) {
    if (adaptation.type != AdaptationType::kRedeploy && adaptation.type != AdaptationType::kStop)
      continue;
    const auto& others = knowledge.components[adaptation.component].ends_with;
    all.insert(all.end(), others.begin(), others.end());
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  std::erase_if(all, [&](ComponentId c) {
    return std::find(strategy.components.begin(), strategy.components.end(), c) !=
           strategy.components.end();
  });
  return all;
}

}  // namespace culprit::plan
