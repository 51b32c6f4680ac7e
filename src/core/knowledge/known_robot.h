// The make-up of the robot by name, as one run of culprit saw it. The next run reads it, so that it
// knows the dependencies, and which components exited in between.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "language/rule_set.h"
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
    int pid = 0;  // the process of this machine that its node was in; 0: not known, or it ended
    std::string host{};  // the other computer that its node ran on last, as ComponentState::host
    bool operator==(const Part&) const = default;
  };
  std::vector<Part> parts;
  std::vector<std::string> topics;  // that were seen (discovered.h)
  std::map<std::string, std::string>
      publishers{};  // by diagnostic status: the node whose word counts

  // The rest is for a run that comes soon, with the same rules: once all that was seen is there again,
  // it need not wait any longer for more (monitor_start.cpp).

  // Topics of which messages came, since the process of the one node that published them began.
  std::vector<std::string> heard{};
  std::vector<std::string> read{};  // what had a value: "signal dark", "lifecycle camera"
  bool is_whole = false;  // the run had its time to see what there is, and this one may rely on it
  bool operator==(const KnownRobot&) const = default;
};

// As KnownRobot::read has it; empty where it is a topic's rhythm, or whether a component is alive.
std::string value_name(const Input& input, const RuleSet& rules);

}  // namespace culprit
