// The rules of a scenario: all that a manager knows of the robot beforehand.
//
// One rule for each watched component: its detector reports that it is ill. The author of the rules knows how often a reading is wrong and has a failure hold
// in as many of a few readings as make a false detection rare.
#pragma once

#include <string>

#include "rca_study/rca_scenario.h"

namespace culprit::study::rca {

// In the rule language.
std::string rules_text(const RcaScenario& scenario);

// The same, checked. Component number i is component i; rule number i and signal number i are those
// of the i-th component that is watched.
RuleSet rules_of(const RcaScenario& scenario);

}  // namespace culprit::study::rca
