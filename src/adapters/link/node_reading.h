// Reads what one node reports of itself: its parameters and, if it is managed, its lifecycle state.
//
// Each parameter is read once, and then followed by the events on /parameter_events; the state is
// read once, and then followed by the node's transition events.
#pragma once

#include <memory>
#include <string>

#include "base/mutex.h"
#include "language/live_inventory.h"
#include "ros2/node.h"
#include "ros2/services.h"

namespace culprit::link {

// On the executor's thread, but for told().
class NodeReading {
 public:
  // More parameters of one node are left out.
  static constexpr std::size_t kMaxParameters = 10'000;

  // `self` is our own node and outlives the reading; `node` is the full name of the other one.
  NodeReading(ros2::Node& self, std::string node) : self_(self), node_(std::move(node)) {}

  // The node was discovered to offer a service.
  void service_seen(const std::string& service);
  // It announced changes.
  void parameters_changed(const ros2::msg::ParameterEvent& event);

  // From any thread.
  LiveInventory::Node told() const;

 private:
  void list_parameters();
  void get_parameters(std::vector<std::string> names);
  void read_lifecycle();
  void set_lifecycle(std::uint8_t state);

  ros2::Node& self_;
  const std::string node_;
  mutable Mutex mutex_;
  LiveInventory::Node told_ CULPRIT_GUARDED_BY(mutex_);
  std::unique_ptr<ros2::Client<ros2::srv::ListParameters>> list_;
  std::unique_ptr<ros2::Client<ros2::srv::GetParameters>> get_;
  std::unique_ptr<ros2::Client<ros2::srv::GetState>> state_;
  std::unique_ptr<ros2::Subscription> transitions_;
};

}  // namespace culprit::link
