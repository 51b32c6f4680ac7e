// The mode manager of system_modes: changes the modes of systems, and infers in which they are.
//
// A system is a name for some nodes, its parts. Each of its modes says of each part whether it is
// active, and then with which values of its parameters. Whoever wants another mode asks for it by
// the system's name.
// - What is accepted is not done: the parts are told, each in its own time, and nobody waits for
//   their answers. A mode that the system is in already is not asked for again.
// - In which mode a system is, is inferred from what the parts announce: the mode that was asked
//   for last if they fit it, or else the first that they fit.
// - It is a node like others: it has one executor thread, and it can be killed and hang. A new
//   process asks the parts how they are, for it has heard nothing.
// Systems of systems, rules and modes of plain nodes are not modelled.
// Source: system_modes (micro-ROS), README and mode_inference.cpp.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "simulation/node.h"

namespace culprit::simulation {

// What a mode wants of one part.
struct PartMode {
  std::string node;                         // full name
  bool is_active = true;                    // otherwise inactive, and the parameters do not matter
  std::map<std::string, Value> parameters;  // that it sets
};

struct SystemMode {
  std::string name;
  std::vector<PartMode> parts;
};

struct ModeSystem {
  std::string name;               // "/namespace/name"
  std::vector<SystemMode> modes;  // the default first
};

class ModeManager : public Node, private Watcher {
 public:
  // `world` must outlive it.
  ModeManager(World& world, std::string name, std::vector<ModeSystem> systems, NodeTraits traits);
  ~ModeManager() override;

  // Gives whether the request is accepted: whether there is such a mode.
  bool change_mode(const std::string& system, const std::string& mode);
  // The inferred mode.
  std::string mode_of(const std::string& system) const;

 private:
  // What a part announced last.
  struct Heard {
    Lifecycle lifecycle = Lifecycle::kUnknown;
    std::map<std::string, Value> parameters;
  };

  void on_start() override;
  void on_node(const Node& node, bool is_there) override;
  void on_lifecycle(const Node& node) override;
  void on_parameter(const Node& node, const std::string& name, const Value& value) override;

  const ModeSystem& find(const std::string& system) const;
  bool is_part(const std::string& node) const { return heard_.contains(node); }
  bool fits(const SystemMode& mode) const;
  void command(const PartMode& part);
  void hear(const std::string& node, std::function<void(Heard&)> news);
  // Has the node's executor do `work`, after the way there.
  void ask(const std::string& node, std::function<void(Node&)> work);

  std::vector<ModeSystem> systems_;
  std::map<std::string, std::string> targets_;  // by system, what was asked for last
  std::map<std::string, Heard> heard_;          // by part
};

}  // namespace culprit::simulation
