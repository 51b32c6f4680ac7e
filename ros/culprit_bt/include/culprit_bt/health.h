// Whether a component, or the whole robot, is well by what culprit tells.
//
// A component is well when its node is there, no rule that fails touches it, its process neither stopped,
// hung nor ended, and no strategy changes it: the same that the action ~/wait_for_recovery waits for. The
// robot is when all of its components are, and nothing else is wrong.
#pragma once

#include <cstdint>
#include <string>

#include "culprit_bt/culprit.h"

namespace culprit_bt {

enum class Outlook : std::uint8_t {
  kWell,
  kIll,
  kUnknown,         // culprit is not there, or cannot hear the robot
  kNoSuchComponent  // the rules have none of that name
};

struct Health {
  Outlook outlook = Outlook::kUnknown;
  std::string
      reason;  // for people: what is wrong, or why nothing is known; empty where all is well
};

// How ill something may be and still count as well: a culprit_msgs/msg/Component::HEALTH_... "OK" is
// nothing at all; then "NON_CRITICAL" and "WARNING". Throws BT::RuntimeError for any other word.
std::uint8_t tolerated(const std::string& word);

// `component`: empty for the whole robot.
Health health_of(const Knowledge& known, const std::string& component, std::uint8_t tolerated);

// The same, but it is ill, too, while an open incident names it: culprit holds it responsible, or suspects
// it.
Health incident_at(const Knowledge& known, const std::string& component, std::uint8_t tolerated);

}  // namespace culprit_bt
