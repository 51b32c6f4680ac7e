// What a run of culprit knows of the make-up of its robot, by name, for the run that comes next: so
// that what died in between is known to have died, and who depends on it.
#pragma once

#include <string>
#include <vector>

#include "robot/observation.h"

namespace culprit {

struct KnownRobot {
  // A node publishes or subscribes to a topic, serves or uses a service.
  struct End {
    EndpointKind kind{};
    std::string name;
    bool operator==(const End&) const = default;
  };
  // A component that was seen. Under rules that give it another NODE it was not.
  struct Part {
    std::string component;
    std::string node;
    std::vector<End> ends;
    bool operator==(const Part&) const = default;
  };
  std::vector<Part> parts;
  std::vector<std::string> topics;  // that were seen (sightings.h)
  bool operator==(const KnownRobot&) const = default;
};

}  // namespace culprit
