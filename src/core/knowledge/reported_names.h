// The names that the robot's diagnostics and parameters really have, as far as they were received:
// suggestions for a misspelt name (named.h).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "robot/observation.h"

namespace culprit {

struct ReportedNames {
  std::vector<StatusHeard> statuses;
  std::map<ComponentId, std::vector<std::string>> parameters;
};

}  // namespace culprit
