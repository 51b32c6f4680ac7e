// From what the database knows of other robots to what the planner's beliefs begin with, and to
// strategies that fare differently on this robot.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "fleet/tally.h"
#include "knowledge/pooled_prior.h"
#include "language/rule_set.h"
#include "robot/observation.h"

namespace culprit::fleet {

// The outcomes of one strategy.
struct StrategyKnowledge {
  std::map<std::string, RobotOutcomes> models;  // this robot's outcomes included, where it has any
  // This robot's share of those: fading as they do, and in all.
  double recent_helped = 0;
  double recent_failed = 0;
  Counts own;
};

struct FleetKnowledge {
  std::string model;  // of this robot
  std::map<StrategyName, StrategyKnowledge> strategies;
};

// As text, for the next start without a database, and back; a damaged text gives nothing.
std::string to_text(const FleetKnowledge& knowledge);
FleetKnowledge knowledge_from_text(const std::string& text);

// For each strategy of `rules`: the fleet's prior, or the designer's where nobody has outcomes.
PriorsTold priors_for(const RuleSet& rules, const FleetKnowledge& knowledge);

// Those of `news` that are not nearly the same in `known`, which may lack some.
PriorsTold changes(const PriorsTold& known, const PriorsTold& news);

// A strategy that fares on this robot as it hardly would if this robot were like the others.
struct Deviation {
  StrategyName name;
  Counts own;
  double fleet = 0;        // the success rate of the others
  double probability = 0;  // of faring like this or worse, if it were one of them
};
inline constexpr double kHardly = 0.001;
std::vector<Deviation> deviations(const RuleSet& rules, const FleetKnowledge& knowledge);
std::string describe(const Deviation& deviation);

}  // namespace culprit::fleet
