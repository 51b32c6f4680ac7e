// The nodes that a launch file starts, as play_launch (github.com/NEWSLabNTU/play_launch) dumps it: its system_model.yaml (from 0.9 on), or its record.json
// (before). Only facts that cannot be read from processes are taken: how the nodes of component containers are loaded, and which processes are started again
// after they exit.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/expected.h"

namespace culprit::init {

// How a container is asked to load a node.
struct Recipe {
  std::string container;  // the full name of its node
  std::string package;
  std::string plugin;                                           // "package::Class"
  std::vector<std::pair<std::string, std::string>> parameters;  // values as YAML has them
  std::vector<std::pair<std::string, std::string>> remaps;      // from, to
  bool operator==(const Recipe&) const = default;
};

struct LaunchDump {
  std::map<std::string, Recipe> recipes;  // by the node's full name
  std::set<std::string> respawned;        // nodes, by full name
  // It is of the launch that runs: its containers have no other components. Other nodes there were made by a component.
  bool is_of_running = false;
  bool operator==(const LaunchDump&) const = default;
};

// `text` is the content of `file`. Errors: it is neither; with the line where there is one.
Expected<LaunchDump> read_launch_dump(const std::string& text, const std::string& file);

}  // namespace culprit::init
