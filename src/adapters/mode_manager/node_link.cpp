#include "mode_manager/node_link.h"

#include "ros2/services.h"

namespace culprit::mode_manager {
namespace {

using namespace std::chrono_literals;
using ros2::CallOutcome;
using ros2::CallResult;
using ros2::Repeat;

constexpr Duration kJoining = 30s;  // until a node that was just seen answers
constexpr Duration kPatience = 5s;

}  // namespace

Expected<std::unique_ptr<NodeLink>> NodeLink::create(ros2::Node& self, const modes::Entity& node,
                                                     Ears ears) {
  std::unique_ptr<NodeLink> link(new NodeLink(self, node, std::move(ears)));
  if (auto opened = link->open(self); !opened) return Error{opened.error()};
  return link;
}

NodeLink::NodeLink(ros2::Node& self, const modes::Entity& node, Ears ears)
    : node_(node), ears_(std::move(ears)), tasks_(self.context().executor()) {}

Expected<void> NodeLink::open(ros2::Node& self) {
  auto transitions = self.create_subscription<ros2::msg::TransitionEvent>(
      node_.name + "/transition_event", rtps::qos::kDefault,
      [this](const ros2::msg::TransitionEvent& event) {
        has_told_state_ = true;
        ears_.on_state(static_cast<LifecycleState>(event.goal_state.id));
      });
  if (!transitions) return Error{transitions.error()};
  transitions_ = std::move(*transitions);
  auto lifecycle = ros2::ServiceClient::create(
      self.entry(), {node_.name + "/change_state", std::string(ros2::srv::ChangeState::kType)},
      rtps::qos::kServices,
      {{node_.name + "/get_state", std::string(ros2::srv::GetState::kType)},
       rtps::encode(ros2::srv::GetState::Request{})});
  if (!lifecycle) return Error{lifecycle.error()};
  lifecycle_ = std::move(*lifecycle);
  auto parameters = ros2::ServiceClient::create(
      self.entry(),
      {node_.name + "/set_parameters_atomically",
       std::string(ros2::srv::SetParametersAtomically::kType)},
      rtps::qos::kParameterServices,
      {{node_.name + "/get_parameters", std::string(ros2::srv::GetParameters::kType)},
       rtps::encode(ros2::srv::GetParameters::Request{})});
  if (!parameters) return Error{parameters.error()};
  parameters_ = std::move(*parameters);
  return {};
}

void NodeLink::read() {
  has_told_state_ = false;
  announced_.clear();
  lifecycle_->probe()->call(rtps::encode(ros2::srv::GetState::Request{}), Repeat::kUntilAnswered,
                            kJoining, [this](const CallResult& result) {
                              if (result.outcome != CallOutcome::kAnswered) return;
                              const auto response =
                                  rtps::decode<ros2::srv::GetState::Response>(result.reply);
                              if (!response) return;
                              tasks_.post([this, id = response->current_state.id] {
                                if (!has_told_state_)
                                  ears_.on_state(static_cast<LifecycleState>(id));
                              });
                            });
  // One by one: a name that is not declared would leave all of them unanswered.
  for (const auto& [parameter, value] : node_.modes.front().parameters) read_parameter(parameter);
}

void NodeLink::read_parameter(const std::string& parameter) {
  parameters_->probe()->call(
      rtps::encode(ros2::srv::GetParameters::Request{{parameter}}), Repeat::kUntilAnswered,
      kJoining, [this, parameter](const CallResult& result) {
        if (result.outcome != CallOutcome::kAnswered) return;
        const auto response = rtps::decode<ros2::srv::GetParameters::Response>(result.reply);
        if (!response || response->values.size() != 1) return;
        const auto value = ros2::to_value(response->values.front());
        if (!value) return;
        tasks_.post([this, parameter, value = *value] {
          if (!announced_.contains(parameter)) ears_.on_parameter(parameter, value);
        });
      });
}

void NodeLink::announced(const std::string& parameter, const Value& value) {
  announced_.insert(parameter);
  ears_.on_parameter(parameter, value);
}

void NodeLink::change(ros2::TransitionId transition) {
  const ros2::msg::Transition wanted{static_cast<std::uint8_t>(transition), ""};
  lifecycle_->call(rtps::encode(ros2::srv::ChangeState::Request{wanted}), Repeat::kNever, kPatience,
                   [this, transition](const CallResult& result) {
                     const auto response =
                         result.outcome == CallOutcome::kAnswered
                             ? rtps::decode<ros2::srv::ChangeState::Response>(result.reply)
                             : std::nullopt;
                     if (response && response->success) return;
                     const std::string asked =
                         transition == ros2::TransitionId::kActivate ? " activated" : " changed";
                     tasks_.post([this, asked, is_refusal = response.has_value()] {
                       ears_.on_trouble(node_.name + " was not" + asked +
                                        (is_refusal ? ": it refused" : ": it did not answer"));
                     });
                   });
}

void NodeLink::set(const std::map<std::string, Value>& parameters) {
  if (parameters.empty()) return;
  ros2::srv::SetParametersAtomically::Request request;
  for (const auto& [name, value] : parameters)
    request.parameters.push_back({name, ros2::to_parameter_value(value)});
  parameters_->call(
      rtps::encode(request), Repeat::kNever, kPatience, [this](const CallResult& result) {
        const auto response =
            result.outcome == CallOutcome::kAnswered
                ? rtps::decode<ros2::srv::SetParametersAtomically::Response>(result.reply)
                : std::nullopt;
        if (response && response->result.successful) return;
        const std::string why =
            response ? "it refused, " + response->result.reason : std::string("it did not answer");
        tasks_.post([this, why] {
          ears_.on_trouble("the parameters of " + node_.name + " were not set: " + why);
        });
      });
}

}  // namespace culprit::mode_manager
