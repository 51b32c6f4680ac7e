// What the robot calls its diagnostics and parameters, as far as it was heard: for whoever wrote such
// a name otherwise (named.h).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "robot/observation.h"

namespace culprit {

struct HeardNames {
  std::vector<StatusHeard> statuses;
  std::map<ComponentId, std::vector<std::string>> parameters;
};

}  // namespace culprit
