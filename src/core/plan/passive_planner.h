// A planner that decides nothing: for programs and tests that only need the manager's view of the
// robot.
#pragma once

#include "plan/planner.h"

namespace culprit {

class PassivePlanner : public Planner {
 public:
  std::vector<Decision> plan(std::span<const RuleId>, const Knowledge&) const override {
    return {};
  }
};

}  // namespace culprit
