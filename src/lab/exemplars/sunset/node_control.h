// Reads and steers one managed node from outside, through its standard services.
//
// Each call ends in its callback, once, on the executor's thread: with what was asked for, or with
// a reason for people that names the node. A node that does not answer costs kPatience; a
// transition, in which a node may work, kTransitionPatience.
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <string>

#include "base/expected.h"
#include "base/value.h"
#include "ros2/lifecycle.h"
#include "ros2/node.h"
#include "ros2/services.h"

namespace culprit::sunset {

template <class T>
using Then = std::function<void(Expected<T>)>;

// Begins a call that ends in a callback; the future has what the callback gets.
template <class T, class Begin>
std::future<Expected<T>> ask(Begin begin) {
  const auto promise = std::make_shared<std::promise<Expected<T>>>();
  auto future = promise->get_future();
  begin([promise](Expected<T> answer) { promise->set_value(std::move(answer)); });
  return future;
}

class NodeControl {
 public:
  static constexpr Duration kPatience = std::chrono::seconds(2);
  static constexpr Duration kTransitionPatience = std::chrono::seconds(5);

  // `from` outlives the control.
  static Expected<std::unique_ptr<NodeControl>> create(ros2::Node& from,
                                                       const ros2::NodeName& target);

  void set_parameter(const std::string& name, const Value& value, Then<void> then);
  void get_parameter(const std::string& name, Then<Value> then);
  void get_state(Then<LifecycleState> then);
  void change_state(ros2::TransitionId transition, Then<void> then);

 private:
  template <class Service>
  using ClientPointer = std::unique_ptr<ros2::Client<Service>>;

  explicit NodeControl(std::string target) : target_(std::move(target)) {}
  Expected<void> open(ros2::Node& from);
  // The error of a call without a usable answer.
  Error trouble(ros2::CallOutcome outcome) const;

  const std::string target_;  // full name
  ClientPointer<ros2::srv::SetParameters> set_parameters_;
  ClientPointer<ros2::srv::GetParameters> get_parameters_;
  ClientPointer<ros2::srv::GetState> get_state_;
  ClientPointer<ros2::srv::ChangeState> change_state_;
};

}  // namespace culprit::sunset
