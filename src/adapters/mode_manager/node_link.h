// One managed node, as the mode manager speaks to it.
//
// Each request is sent once and not awaited; a refusal is reported. Callbacks run on the executor's
// thread.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "modes/model.h"
#include "ros2/lifecycle.h"
#include "ros2/node.h"

namespace culprit::mode_manager {

class NodeLink {
 public:
  struct Ears {
    std::function<void(LifecycleState)> on_state;
    std::function<void(const std::string& parameter, const Value&)> on_parameter;
    std::function<void(std::string)> on_trouble;
  };

  // `self` outlives the link.
  static Expected<std::unique_ptr<NodeLink>> create(ros2::Node& self, const modes::Entity& node,
                                                    Ears ears);

  // Reads its state and parameters, as soon as it answers.
  void read();
  // It announced a value, which is newer than any that is being read.
  void announced(const std::string& parameter, const Value& value);
  void change(ros2::TransitionId transition);
  void set(const std::map<std::string, Value>& parameters);

 private:
  NodeLink(ros2::Node& self, const modes::Entity& node, Ears ears);
  Expected<void> open(ros2::Node& self);
  void read_parameter(const std::string& parameter);

  const modes::Entity& node_;
  const Ears ears_;
  // The announcements since the last read() began.
  bool has_told_state_ = false;
  std::set<std::string> announced_;

  ros2::TaskGroup tasks_;  // outlives those that post to it
  std::unique_ptr<ros2::Subscription> transitions_;
  std::unique_ptr<ros2::ServiceClient> lifecycle_;
  std::unique_ptr<ros2::ServiceClient> parameters_;
};

}  // namespace culprit::mode_manager
