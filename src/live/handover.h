// The legacy of one session of a run to the next one, whose rules may be others: all by name, as far as those have it.
#pragma once

#include <string>
#include <vector>

#include "journal/learned.h"
#include "knowledge/history.h"
#include "knowledge/known_robot.h"
#include "manager/manager.h"

namespace culprit::live {

struct Handover {
  journal::Learned learned;
  KnownRobot known_robot;
  History verdicts;                 // that do not count yet
  std::vector<Observation> orders;  // of people, that still hold
  std::string occasion;             // why there is a next one
};

journal::Learned learned_by(const Knowledge& knowledge);

// Verdicts that wait for their proof. None is due before the next session has had the time to see
// the robot: time without observation does not count.
History waiting_verdicts(const Knowledge& knowledge, const RuleSet& next, Time first);

// The orders that still hold. `advised_at_first`: the manager began so, without an order.
std::vector<Observation> standing_orders(const Manager& manager, bool advised_at_first,
                                         const RuleSet& next, Time now);

}  // namespace culprit::live
