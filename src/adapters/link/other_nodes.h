// The nodes that the process of a component has besides the one that the component is named after:
// whether they answer (Probed).
//
// On the executor's thread.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "inbox/inbox.h"
#include "robot/component_binding.h"
#include "ros2/graph.h"
#include "ros2/service_client.h"

namespace culprit::link {

class OtherNodes {
 public:
  // All outlive it.
  OtherNodes(ros2::NodeEntry& self, const ComponentBinding& binding, Inbox& inbox)
      : self_(self), binding_(binding), inbox_(inbox) {}

  // Whether `node` is one of them.
  bool has(ComponentId component, const std::string& node) const {
    return binding_.has_several(component) && binding_.node_of(component) != node;
  }

  void joined(ComponentId component, const ros2::GraphNode& node);
  void left(const std::string& node);

  // Asks each one that is there, and reports whether it answers.
  void probe();
  // Asks one, and gives the participant that answers, if any does. `then` may be called before this
  // returns.
  void ask(const std::string& node, std::function<void(std::optional<rtps::GuidPrefix>)> then);

 private:
  struct Node {
    ComponentId component;
    std::uint8_t place = 1;  // Probed::node
    int pid = 0;
    bool is_there = false;
    std::unique_ptr<ros2::ServiceClient> client;  // null: a secured domain need not allow one
  };

  ros2::NodeEntry& self_;
  const ComponentBinding& binding_;
  Inbox& inbox_;
  std::map<std::string, Node> nodes_;  // by name
};

}  // namespace culprit::link
