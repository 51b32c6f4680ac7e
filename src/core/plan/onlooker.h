// A planner that decides nothing: for whoever wants to know what a manager sees, and that it does
// nothing about it.
#pragma once

#include "plan/planner.h"

namespace culprit {

class Onlooker : public Planner {
 public:
  std::vector<Decision> plan(std::span<const RuleId>, const Knowledge&) const override {
    return {};
  }
};

}  // namespace culprit
