#include "manager/runtime.h"

#include <algorithm>

namespace culprit {

void Runtime::run(const std::atomic<bool>& stop, Time end) {
  std::vector<Observation> observations;
  while (!stop && robot_.now() < end) {
    observations.clear();
    robot_.observe(std::min(end, manager_.next_deadline()), observations);
    for (const Command& command : manager_.step(robot_.now(), observations))
      robot_.execute(command);
    if (!manager_.events().empty() && on_events) on_events(manager_.events());
  }
}

}  // namespace culprit
