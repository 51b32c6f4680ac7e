// Faults of a simulated robot, as data: the fault, its place and its time.
#pragma once

#include <string>
#include <variant>

#include "base/expected.h"
#include "simulation/topic.h"

namespace culprit::simulation {

// A parameter has a bad value.
struct BadParameter {
  std::string name;
  Value value;
};
// The process is killed; `failing_starts` of its next starts fail.
struct Killed {
  int failing_starts = 0;
};
struct Stopped {};    // SIGSTOP
struct Continued {};  // SIGCONT
struct Hung {};       // a callback does not come back
// Messages of `topic` come later, or are lost, from now on: the fault of a network, not of a node.
struct Impaired {
  std::string topic;
  Transport transport;
};

struct Fault {
  Time at{};
  std::string node;  // full name; empty for Impaired
  std::variant<BadParameter, Killed, Stopped, Continued, Hung, Impaired> what;
};

// Lets it happen when its time has come. An error: there is no such node, parameter or topic.
Expected<void> inject(World& world, const Fault& fault);

}  // namespace culprit::simulation
