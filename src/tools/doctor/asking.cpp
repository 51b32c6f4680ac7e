#include "doctor/asking.h"

#include <algorithm>

#include "owners/parameter_file.h"
#include "ros2/lifecycle.h"
#include "ros2/process_finder.h"

namespace culprit::doctor {
namespace {

constexpr std::size_t kMostParameters =
    10'000;  // of one node: the network decides how many there are
constexpr const char* kSimulatedTime = "use_sim_time";

std::string label_of(std::uint8_t state) {
  for (const LifecycleState known : ros2::lifecycle_states()) {
    if (static_cast<std::uint8_t>(known) == state) return std::string(ros2::label_of(known));
  }
  return "";
}

}  // namespace

Asking::Parameters* Asking::parameters_client(const std::string& node) {
  std::unique_ptr<Parameters>& client = parameter_clients_[node];
  if (client == nullptr) {
    auto made = self_.create_client<ros2::srv::GetParameters>(node + "/get_parameters",
                                                              rtps::qos::kParameterServices);
    if (made) client = std::move(*made);
  }
  return client.get();
}

void Asking::ask_whether_it_answers(const ros2::GraphNode& node, Duration patience) {
  Parameters* client = parameters_client(node.name);
  if (client == nullptr) return;
  client->call({{kSimulatedTime}}, ros2::Repeat::kUntilAnswered, patience,
               [this, node, patience](const Parameters::Answer& answer) {
                 if (answer.outcome == ros2::CallOutcome::kTimedOut) {
                   // A node that was never reached is no proof.
                   const bool has_ended =
                       node.pid != 0 && !ros2::ProcessFinder().is_running(node.pid);
                   unanswered_[node.name] = {seconds(patience), has_ended};
                 } else if (answer.response && !answer.response->values.empty() &&
                            answer.response->values.front().type ==
                                static_cast<std::uint8_t>(ros2::msg::ParameterType::kBool)) {
                   uses_simulated_time_[node.name] = answer.response->values.front().bool_value;
                 }
               });
}

void Asking::ask_for_state(const std::string& node, Time now, Duration patience) {
  std::unique_ptr<State>& client = state_clients_[node];
  if (client == nullptr) {
    auto made = self_.create_client<ros2::srv::GetState>(node + "/get_state");
    if (!made) return;
    client = std::move(*made);
  }
  const auto [first, is_first] = asked_for_state_.try_emplace(node, now);
  client->call(
      {}, ros2::Repeat::kUntilAnswered, patience,
      [this, node, is_first = is_first, since = now - first->second](const State::Answer& answer) {
        if (!answer.response) return;
        Lifecycle& state = lifecycles_[node];
        state.last = label_of(answer.response->current_state.id);
        if (is_first) state.first = state.last;
        state.between = since;
      });
}

void Asking::ask_for_parameters(const std::string& node, const std::vector<std::string>& names,
                                Duration patience) {
  std::unique_ptr<Names>& client = name_clients_[node];
  if (client == nullptr) {
    auto made = self_.create_client<ros2::srv::ListParameters>(node + "/list_parameters",
                                                               rtps::qos::kParameterServices);
    if (!made) return;
    client = std::move(*made);
  }
  client->call({}, ros2::Repeat::kUntilAnswered, patience,
               [this, node, names, patience](const Names::Answer& answer) {
                 if (!answer.response) return;
                 std::vector<std::string> there = answer.response->names;
                 std::erase_if(there, [&](const std::string& name) {
                   return !names.empty() && std::ranges::find(names, name) == names.end();
                 });
                 there.resize(std::min(there.size(), kMostParameters));
                 get_parameters(node, std::move(there), patience);
               });
}

// With a name that is not declared nothing is answered for all of them (rclcpp, Humble).
void Asking::get_parameters(const std::string& node, std::vector<std::string> names,
                            Duration patience) {
  Parameters* client = parameters_client(node);
  if (client == nullptr || names.empty()) return;
  client->call({names}, ros2::Repeat::kUntilAnswered, patience,
               [this, node, names](const Parameters::Answer& answer) {
                 if (!answer.response || answer.response->values.size() != names.size()) return;
                 for (std::size_t i = 0; i < names.size(); ++i)
                   parameters_[node][names[i]] = owners::to_yaml(answer.response->values[i]);
               });
}

void Asking::begin_anew(const std::function<bool(const std::string&)>& is_there) {
  unanswered_.clear();
  uses_simulated_time_.clear();
  lifecycles_.clear();
  asked_for_state_.clear();
  parameters_.clear();
  const auto is_gone = [&](const auto& client) { return !is_there(client.first); };
  std::erase_if(parameter_clients_, is_gone);
  std::erase_if(name_clients_, is_gone);
  std::erase_if(state_clients_, is_gone);
}

}  // namespace culprit::doctor
