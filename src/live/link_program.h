// The helper program of --link ros: where it is, and the environment of the robot that it joins.
#pragma once

#include <memory>
#include <string>

#include "base/expected.h"
#include "language/rule_set.h"
#include "ros2/helper_options.h"

namespace culprit::live {

// In the environment that the first SETUP of the rules leaves, or in culprit's own without one. `program`: its path;
// empty: it is looked up there, in AMENT_PREFIX_PATH (lib/culprit_link/culprit_link) and then in PATH. Takes as long as
// the SETUP does. Errors: there is none, or the SETUP fails.
Expected<std::shared_ptr<const ros2::HelperOptions>> link_program(const RuleSet& rules,
                                                                  const std::string& program);

}  // namespace culprit::live
