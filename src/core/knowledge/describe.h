// Events in words, one line each, for terminals and logs.
#pragma once

#include <string>
#include <vector>

#include "knowledge/departures.h"
#include "knowledge/event.h"

namespace culprit {

std::string_view to_string(Criticality criticality);

// The word of rule tests and documents for it: "tried", "dependency", "other_chosen".
std::string_view to_string(Condition condition);
std::string_view to_string(OutcomeCounted::As as);

// As an expression has it: "segmentation_entropy", "age(/rgb)", "mean(load, 2s)"
std::string describe(const Input& input, const RuleSet& rules);

// Why it stays down: "a person ended the launch of process 50, camera with it". @pre it does
std::string describe(const Departures::Departure& departure, const std::string& component);

// "87.3 %", "60 %"
std::string to_string(Probability probability);
// "0.70"
std::string two_decimals(double value);

// "a, b and c"
std::string listed(const std::vector<std::string>& items);

// "camera is muted for 10 min", "restart_camera is approved"
std::string describe(const Order& order, const RuleSet& rules);

// "restart camera", "set exposure of camera"
std::string describe(const Adaptation& adaptation, const RuleSet& rules);

// "deactivate planner", "then redeploy driver": one each. And all of them in one sentence.
std::vector<std::string> action_list(const Strategy& strategy, const RuleSet& rules);
std::string actions_of(const Strategy& strategy, const RuleSet& rules);

// "camera is held responsible for RGBDead: restart camera (rgb_restart, relative cost 0.70)". May be empty: nothing
// worth a line.
std::string describe(const Event& event, const RuleSet& rules);

// Why a candidate was not chosen: "sensor_fusion depends on camera, which may be the cause
// (RGBDead)".
std::string describe_exclusion(const Candidate& candidate, const RuleSet& rules);
// The event that would end its wait, and its consequence: "if camera does not answer within 0.60 s, camera is held
// responsible". Empty if its wait has no known end.
std::string describe_end_of_wait(const Candidate& candidate, const RuleSet& rules);

}  // namespace culprit
