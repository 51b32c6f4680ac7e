// Which modes a robot's systems and nodes have: the model of system_modes.
//
// A node is a managed node; each of its modes sets some of its parameters. A system is a name for
// some parts, nodes or other systems; each of its modes gives for each part whether it is active,
// and then in which mode. The first mode is the default. Source: system_modes (micro-ROS), README
// and mode_impl.cpp.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/value.h"

namespace culprit::modes {

inline constexpr const char* kDefaultMode = "__DEFAULT__";

// The target of a part: "inactive", "active.FAST".
struct Target {
  bool is_active = true;
  std::string mode;  // empty of what is inactive
  auto operator<=>(const Target&) const = default;
};

// As the model file writes it.
std::string to_string(const Target& target);

struct Mode {
  std::string name;
  std::map<std::string, Target> parts;      // of a system, each of its parts
  std::map<std::string, Value> parameters;  // of a node
  bool operator==(const Mode&) const = default;
};

// Where a system aims at `if_target` and is not there, and `part` is `if_part`, it is to aim at
// `new_target` instead.
struct Rule {
  std::string name;
  Target if_target;
  std::string part;
  Target if_part;
  Target new_target;
  bool operator==(const Rule&) const = default;
};

// A system or a node. Names are full: "/namespace/name".
struct Entity {
  std::string name;
  bool is_system = false;
  std::vector<std::string> parts;
  std::vector<Mode> modes;
  std::vector<Rule> rules;

  const Mode* find(std::string_view mode) const;
  bool operator==(const Entity&) const = default;
};

// Parts come before the systems that they are parts of.
struct Model {
  std::vector<Entity> entities;

  const Entity* find(std::string_view name) const;
  bool operator==(const Model&) const = default;
};

}  // namespace culprit::modes
