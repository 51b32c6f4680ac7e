// The mode managers of system_modes, and the systems that they represent: a system is no node, its manager offers its
// services, and it is there as long as the manager is.
//
// On the executor's thread.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "inbox/inbox.h"
#include "ros2/graph.h"

namespace culprit::link {

// Nodes and systems by their full names.
class ModeManagers {
 public:
  // `inbox` must outlive it.
  explicit ModeManagers(Inbox& inbox) : inbox_(inbox) {}

  // Whether the modes of `system` that `manager` offers count, from now on. Reports the first manager that offers
  // them beside another one (LinkTrouble).
  bool may_tell(const std::string& manager, const std::string& system, const ros2::Graph& graph);

  // The system is there by its manager alone.
  void represents(const std::string& manager, const std::string& system);
  // A system that is a node, too, is there by itself.
  void node_joined(const std::string& node);
  // The modes that it offers count no more.
  void node_left(const std::string& node);
  // The systems that are gone with their manager, once.
  std::vector<std::string> systems_gone_with(const std::string& manager);

 private:
  Inbox& inbox_;
  std::map<std::string, std::string> by_system_;             // the node whose modes count
  std::map<std::string, std::vector<std::string>> systems_;  // by the manager's node
  std::set<std::pair<std::string, std::string>>
      told_of_;  // systems, and others that offer their modes
};

}  // namespace culprit::link
