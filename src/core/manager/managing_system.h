// The port of managing systems: whatever watches a robot and adapts it.
//
// culprit's own is Manager. Studies run others on the same robot, to compare them.
#pragma once

#include <span>
#include <vector>

#include "knowledge/event.h"
#include "robot/command.h"
#include "robot/observation.h"

namespace culprit {

class ManagingSystem {
 public:
  virtual ~ManagingSystem() = default;

  // Takes in what was observed, oldest first, and gives the requests that follow. Times never go
  // back; one that does is taken for the latest seen.
  virtual std::vector<Command> step(Time now, std::span<const Observation> observations) = 0;

  // When step wants to be called even if nothing arrives.
  virtual Time next_deadline() const = 0;

  // The events of the last step. Valid until the next.
  virtual std::span<const Event> events() const = 0;
};

}  // namespace culprit
