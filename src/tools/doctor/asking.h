// Questions to the nodes of a robot that change nothing: whether they answer, in which state they are,
// what their parameters are.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "doctor/picture.h"
#include "ros2/node.h"
#include "ros2/services.h"

namespace culprit::doctor {

// On the executor's thread.
class Asking {
 public:
  // `self` outlives it.
  explicit Asking(ros2::Node& self) : self_(self) {}

  // Nodes of rclcpp and rclpy answer questions about their parameters in the thread that runs their
  // callbacks: one that does not answer within `patience` hangs. The question is whether it uses simulated time.
  void ask_whether_it_answers(const ros2::GraphNode& node, Duration patience);
  // Asks a managed node for its state: the first time, and again.
  void ask_for_state(const std::string& node, Time now, Duration patience);
  // Those parameters, or all that it has if `names` is empty.
  void ask_for_parameters(const std::string& node, const std::vector<std::string>& names,
                          Duration patience);

  const std::map<std::string, Unanswered>& unanswered() const { return unanswered_; }
  const std::map<std::string, bool>& uses_simulated_time() const { return uses_simulated_time_; }
  const std::map<std::string, Lifecycle>& lifecycles() const { return lifecycles_; }
  const std::map<std::string, std::map<std::string, std::string>>& parameters() const {
    return parameters_;
  }

  // Forgets the answers, and all about nodes for which not `is_there`.
  void begin_anew(const std::function<bool(const std::string&)>& is_there);

 private:
  using Parameters = ros2::Client<ros2::srv::GetParameters>;
  using Names = ros2::Client<ros2::srv::ListParameters>;
  using State = ros2::Client<ros2::srv::GetState>;

  Parameters* parameters_client(const std::string& node);
  void get_parameters(const std::string& node, std::vector<std::string> names, Duration patience);

  ros2::Node& self_;
  std::map<std::string, Unanswered> unanswered_;
  std::map<std::string, bool> uses_simulated_time_;
  std::map<std::string, Lifecycle> lifecycles_;
  std::map<std::string, Time> asked_for_state_;  // first
  std::map<std::string, std::map<std::string, std::string>> parameters_;
  std::map<std::string, std::unique_ptr<Parameters>> parameter_clients_;
  std::map<std::string, std::unique_ptr<Names>> name_clients_;
  std::map<std::string, std::unique_ptr<State>> state_clients_;
};

}  // namespace culprit::doctor
