// The ports that several leaves have.
#pragma once

#include <string>

#include "behaviortree_cpp/tree_node.h"

namespace culprit_bt {

inline BT::PortsList with_common_ports(BT::PortsList ports) {
  ports.insert(
      BT::InputPort<std::string>("component", "", "as the rules call it; empty: the whole robot"));
  ports.insert(BT::InputPort<std::string>("culprit", "/culprit", "the name of culprit's own node"));
  return ports;
}

// The value of a port, or of its connection. Throws BT::RuntimeError if there is none, or it is no T.
template <typename T>
T input(const BT::TreeNode& leaf, const std::string& port) {
  const auto value = leaf.getInput<T>(port);
  if (!value) throw BT::RuntimeError(leaf.name(), ": port ", port, ": ", value.error());
  return value.value();
}

}  // namespace culprit_bt
