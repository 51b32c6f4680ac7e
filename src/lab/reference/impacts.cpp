#include "reference/impacts.h"

#include <algorithm>

namespace culprit::study::reference {

Cycles impact_of(AdaptationType type) {
  switch (type) {
    case AdaptationType::kActivate:
    case AdaptationType::kDeactivate:
      return {10};
    case AdaptationType::kRestart:
      return {25};
    case AdaptationType::kRedeploy:
      return {50};
    case AdaptationType::kChangeCommunication:
      return {2};
    default:
      return {1};
  }
}

Cycles sum_of_impacts(const Strategy& strategy) {
  Cycles sum;
  for (const Adaptation& adaptation : strategy.adaptations)
    sum.count += impact_of(adaptation.type).count;
  return sum;
}

Cycles highest_impact(const Strategy& strategy) {
  Cycles highest;
  for (const Adaptation& adaptation : strategy.adaptations)
    highest = std::max(highest, impact_of(adaptation.type));
  return highest;
}

}  // namespace culprit::study::reference
