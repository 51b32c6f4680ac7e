#include "reference/impacts.h"

#include <algorithm>

namespace culprit::study::reference {

Cycles impact(const Adaptation& adaptation, ImpactTable table) {
  if (table == ImpactTable::kRuleFile) return adaptation.impact;
  const bool stray = table == ImpactTable::kStray;
  switch (adaptation.type) {
    case AdaptationType::kActivate:
      return {stray ? 5 : 10};
    case AdaptationType::kDeactivate:
      return {stray ? 1 : 10};
    case AdaptationType::kRestart:
      return {stray ? 10 : 25};
    case AdaptationType::kRedeploy:
      return {stray ? 15 : 50};
    case AdaptationType::kChangeCommunication:
      return {2};
    default:
      return {1};
  }
}

Cycles sum_of_impacts(const Strategy& strategy, ImpactTable table) {
  Cycles sum;
  for (const Adaptation& adaptation : strategy.adaptations)
    sum.count += impact(adaptation, table).count;
  return sum;
}

Cycles highest_impact(const Strategy& strategy, ImpactTable table) {
  Cycles highest;
  for (const Adaptation& adaptation : strategy.adaptations)
    highest = std::max(highest, impact(adaptation, table));
  return highest;
}

}  // namespace culprit::study::reference
