// The calls that break a robot on purpose: of demonstrations only.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/expected.h"
#include "http/routes.h"

namespace culprit::web {

// The faults that can be injected, and functions that do so. The functions are called from any
// thread, and may block.
struct Faults {
  struct Fault {
    std::string name;
    std::string component;  // where it is
  };
  std::vector<Fault> all;
  std::function<Expected<void>(const std::string& name)> inject;
  std::function<Expected<void>()> clear;  // all that were injected
};

std::vector<Route> fault_routes(Faults faults);

}  // namespace culprit::web
