#include "exemplars/sunset/node_control.h"

#include <utility>

namespace culprit::sunset {

namespace srv = ros2::srv;
using ros2::CallOutcome;
using ros2::Repeat;

Expected<std::unique_ptr<NodeControl>> NodeControl::create(ros2::Node& from,
                                                           const ros2::NodeName& target) {
  std::unique_ptr<NodeControl> control(new NodeControl(target.full()));
  if (auto opened = control->open(from); !opened) return Error{opened.error()};
  return control;
}

Expected<void> NodeControl::open(ros2::Node& from) {
  auto set = from.create_client<srv::SetParameters>(target_ + "/set_parameters",
                                                    rtps::qos::kParameterServices);
  auto get = from.create_client<srv::GetParameters>(target_ + "/get_parameters",
                                                    rtps::qos::kParameterServices);
  auto state = from.create_client<srv::GetState>(target_ + "/get_state");
  // A transition is asked for once only, and so needs a probe (service_client.h).
  const auto name = [this](std::string_view service, std::string_view type) {
    return ros2::ServiceName{target_ + std::string(service), std::string(type)};
  };
  auto change = ros2::ServiceClient::create(
      from.entry(), name("/change_state", srv::ChangeState::kType), rtps::qos::kServices,
      {name("/get_state", srv::GetState::kType), rtps::encode(srv::GetState::Request{})});
  if (!set) return Error{set.error()};
  if (!get) return Error{get.error()};
  if (!state) return Error{state.error()};
  if (!change) return Error{change.error()};
  set_parameters_ = std::move(*set);
  get_parameters_ = std::move(*get);
  get_state_ = std::move(*state);
  change_state_ = std::make_unique<ros2::Client<srv::ChangeState>>(from.context().executor(),
                                                                   std::move(*change));
  return {};
}

Error NodeControl::trouble(CallOutcome outcome) const {
  switch (outcome) {
    case CallOutcome::kUnreachable:
      return {target_ + " cannot be reached; is its process running?"};
    case CallOutcome::kTimedOut:
      return {target_ + " does not answer; is its process stopped or busy?"};
    case CallOutcome::kAnswered:
      break;
  }
  return {target_ + " gave an answer that cannot be read"};
}

void NodeControl::set_parameter(const std::string& name, const Value& value, Then<void> then) {
  // May run twice: setting a value again changes nothing.
  set_parameters_->call(
      {{{name, ros2::to_parameter_value(value)}}}, Repeat::kUntilAnswered, kPatience,
      [this, name, then = std::move(then)](const auto& answer) {
        if (!answer.response || answer.response->results.size() != 1) {
          return then(trouble(answer.outcome));
        }
        const auto& result = answer.response->results.front();
        then(result.successful ? Expected<void>()
                               : Error{target_ + " refuses to set " + name + ": " + result.reason});
      });
}

void NodeControl::get_parameter(const std::string& name, Then<Value> then) {
  get_parameters_->call(
      {{name}}, Repeat::kUntilAnswered, kPatience,
      [this, name, then = std::move(then)](const auto& answer) {
        if (!answer.response) return then(trouble(answer.outcome));
        const auto& values = answer.response->values;
        const auto value = values.empty() ? std::nullopt : ros2::to_value(values.front());
        then(value ? Expected<Value>(*value) : Error{target_ + " has no parameter " + name});
      });
}

void NodeControl::get_state(Then<LifecycleState> then) {
  get_state_->call({}, Repeat::kUntilAnswered, kPatience,
                   [this, then = std::move(then)](const auto& answer) {
                     if (!answer.response) return then(trouble(answer.outcome));
                     then(static_cast<LifecycleState>(answer.response->current_state.id));
                   });
}

void NodeControl::change_state(ros2::TransitionId transition, Then<void> then) {
  change_state_->call({{static_cast<std::uint8_t>(transition), {}}}, Repeat::kNever,
                      kTransitionPatience, [this, then = std::move(then)](const auto& answer) {
                        if (!answer.response) return then(trouble(answer.outcome));
                        then(answer.response->success
                                 ? Expected<void>()
                                 : Error{target_ + " did not make the transition"});
                      });
}

}  // namespace culprit::sunset
