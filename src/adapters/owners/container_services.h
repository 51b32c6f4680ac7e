// The port to component containers: the services of a process that loads nodes
// (composition_interfaces).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/expected.h"
#include "base/units.h"
#include "language/rule_set.h"
#include "robot/observation.h"

namespace culprit::owners {

struct LoadedNode {
  std::string name;  // full
  std::uint64_t id = 0;
};

// kDone: it did what was asked. kRefused: it refused, or another process answered. kUnreachable: it
// was not asked. kTimedOut: it was asked and did not answer in time.
struct ContainerAnswer {
  Outcome outcome = Outcome::kDone;
  std::string text{};
  std::vector<LoadedNode> nodes{};  // of list: all; of load: the one that was made
};

// Every call waits at most `patience` for the answer. The answer counts only if it comes from the
// process `pid`, as far as the operating system can prove that. Called on one thread for each
// container.
class ContainerServices {
 public:
  virtual ~ContainerServices() = default;

  virtual ContainerAnswer list(const std::string& container, int pid, Duration patience) = 0;
  virtual ContainerAnswer load(const Component& component, int pid, Duration patience) = 0;
  virtual ContainerAnswer unload(const std::string& container, int pid, std::uint64_t id,
                                 Duration patience) = 0;

  // Whether it can be loaded: its parameters can be read, and the process `pid` would find its
  // class.
  virtual Expected<void> could_load(const Component& component, int pid) const = 0;
  // In words, if several nodes have the container's name: all of them would receive a request.
  virtual std::optional<std::string> contest(const std::string& container) const = 0;

  // The calls that wait return now, and later ones at once.
  virtual void interrupt() = 0;
};

}  // namespace culprit::owners
