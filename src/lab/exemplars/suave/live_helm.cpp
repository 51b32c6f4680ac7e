#include "exemplars/suave/live_helm.h"

#include "exemplars/suave/live_names.h"
#include "exemplars/suave/model/members.h"
#include "exemplars/suave/model/pipeline.h"
#include "exemplars/suave/servo.h"

namespace culprit::suave {
namespace {

using namespace std::chrono_literals;

constexpr Duration kPatience = 5s;

}  // namespace

Expected<std::unique_ptr<LiveHelm>> LiveHelm::create(ros2::Node& node) {
  std::unique_ptr<LiveHelm> helm(new LiveHelm);
  if (auto opened = helm->open(node); !opened) return Error{opened.error()};
  return helm;
}

Expected<void> LiveHelm::open(ros2::Node& node) {
  auto setpoints = node.create_publisher<msg::PoseStamped>(topics::kSetpoint);
  if (!setpoints) return Error{setpoints.error()};
  setpoints_.emplace(std::move(*setpoints));
  auto autopilot = node.create_client<ros2::srv::SetParameters>(
      std::string(model::nodes::kAutopilot) + "/set_parameters", rtps::qos::kParameterServices);
  if (!autopilot) return Error{autopilot.error()};
  autopilot_ = std::move(*autopilot);
  auto battery = node.create_client<ros2::srv::Trigger>(services::kRecharge);
  if (!battery) return Error{battery.error()};
  battery_ = std::move(*battery);
  return subscribe(node);
}

Expected<void> LiveHelm::subscribe(ros2::Node& node) {
  const auto keep = [this](Expected<std::unique_ptr<ros2::Subscription>> made) -> Expected<void> {
    if (!made) return Error{made.error()};
    subscriptions_.push_back(std::move(*made));
    return {};
  };
  for (auto& opened :
       {keep(node.create_subscription<msg::PoseStamped>(
            topics::kPose, rtps::qos::kSensorData,
            [this](const msg::PoseStamped& pose) { seen_ = msg::to_position(pose); })),
        keep(node.create_subscription<msg::PoseStamped>(
            topics::kHome, kLatched,
            [this](const msg::PoseStamped& home) { centre_ = msg::to_position(home); })),
        keep(node.create_subscription<ros2::msg::Int32>(
            topics::kFirstPoint, kLatched, [this](const ros2::msg::Int32& point) {
              const auto number = static_cast<std::size_t>(point.data);
              if (point.data >= 0 && number < model::kPipelinePoints) found_ = number;
            }))}) {
    if (!opened) return opened;
  }
  return {};
}

void LiveHelm::go_to(const model::Position& goal) { setpoints_->publish(msg::to_message(goal)); }

// Both may be asked for twice: they bring about a state.
void LiveHelm::recover(int thruster) {
  autopilot_->call(
      {{{servo_of(thruster), ros2::to_parameter_value(Value(working_servo(thruster)))}}},
      ros2::Repeat::kUntilAnswered, kPatience, [](const auto&) {});
}

void LiveHelm::recharge() {
  battery_->call({}, ros2::Repeat::kUntilAnswered, kPatience, [](const auto&) {});
}

}  // namespace culprit::suave
