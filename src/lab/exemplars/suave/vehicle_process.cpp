#include "exemplars/suave/vehicle_process.h"

#include "exemplars/suave/servo.h"
#include "ros2/services.h"

namespace culprit::suave {

namespace srv = ros2::srv;

VehicleProcess::VehicleProcess(NodeOptions options, const model::Generation& generation,
                               const model::MissionPlan& plan)
    : options_(options),
      generation_(generation),
      plan_(plan),
      world_(options.seed),
      model_topics_(world_) {}

Expected<void> VehicleProcess::open(ros2::Context& context) {
  if (auto opened = open_nodes(context); !opened) return opened;
  auto bridge = Bridge::create(*nodes_.front(), world_);
  if (!bridge) return Error{bridge.error()};
  bridge_ = std::move(*bridge);
  if (auto opened = open_topics(); !opened) return opened;
  if (auto declared = declare_servos(); !declared) return declared;
  if (auto opened = open_services(); !opened) return opened;
  pace_.emplace(context.executor(), world_, options_, model::Vehicle::kStep, [this] { publish(); });
  return {};
}

Expected<void> VehicleProcess::open_nodes(ros2::Context& context) {
  for (const std::string_view name :
       {model::nodes::kAutopilot, model::nodes::kDetector, model::nodes::kVisibility,
        model::nodes::kBattery, model::nodes::kThrusters}) {
    auto node = ros2::Node::create(context, {"/", std::string(name.substr(1))});
    if (!node) return Error{node.error()};
    nodes_.push_back(std::move(*node));
  }
  return {};
}

Expected<void> VehicleProcess::open_topics() {
  ros2::Node& node = *nodes_.front();
  auto poses = node.create_publisher<msg::PoseStamped>(topics::kPose, rtps::qos::kSensorData);
  if (!poses) return Error{poses.error()};
  poses_.emplace(std::move(*poses));
  auto home = node.create_publisher<msg::PoseStamped>(topics::kHome, kLatched);
  if (!home) return Error{home.error()};
  home_.emplace(std::move(*home));
  auto first_point = node.create_publisher<ros2::msg::Int32>(topics::kFirstPoint, kLatched);
  if (!first_point) return Error{first_point.error()};
  first_point_.emplace(std::move(*first_point));
  auto setpoints = node.create_subscription<msg::PoseStamped>(
      topics::kSetpoint, rtps::qos::kDefault, [this](const msg::PoseStamped& setpoint) {
        if (!autopilot_) return;
        pace_->catch_up();
        autopilot_->vehicle().go_to(msg::to_position(setpoint));
      });
  if (!setpoints) return Error{setpoints.error()};
  setpoints_ = std::move(*setpoints);
  for (auto& carried : {bridge_->carry<ros2::msg::Bool>(model_topics_.guided, kLatched),
                        bridge_->carry<ros2::msg::Bool>(model_topics_.detected, kLatched),
                        bridge_->carry<ros2::msg::Bool>(model_topics_.recharged)}) {
    if (!carried) return carried;
  }
  return {};
}

Expected<void> VehicleProcess::declare_servos() {
  auto& parameters = nodes_.front()->parameters();
  for (int thruster = 1; thruster <= model::kThrusters; ++thruster) {
    auto declared = parameters.declare(servo_of(thruster), Value(working_servo(thruster)));
    if (!declared) return declared;
  }
  parameters.on_set([this](std::span<const ros2::msg::Parameter> changes) -> Expected<void> {
    for (const ros2::msg::Parameter& change : changes) {
      for (int thruster = 1; autopilot_ && thruster <= model::kThrusters; ++thruster)
        if (change.name == servo_of(thruster))
          autopilot_->vehicle().set_failed(thruster, change.value.integer_value == 0);
    }
    return {};
  });
  return {};
}

Expected<void> VehicleProcess::open_services() {
  const auto serve = [this](const char* name, std::function<bool()> work) -> Expected<void> {
    auto server = nodes_.front()->create_service<srv::Trigger>(
        name, [work = std::move(work)](const srv::Trigger::Request&) {
          const bool is_done = work();
          return srv::Trigger::Response{is_done, is_done ? "" : "the mission has not begun"};
        });
    if (!server) return Error{server.error()};
    services_.push_back(std::move(*server));
    return {};
  };
  if (auto served = serve(services::kStart, [this] { return begin(), true; }); !served)
    return served;
  return serve(services::kRecharge, [this] {
    if (battery_) battery_->recharge();
    return battery_ != nullptr;
  });
}

void VehicleProcess::begin() {
  if (autopilot_) return;
  pace_->catch_up();
  autopilot_ = std::make_unique<model::Autopilot>(world_, model_topics_, model::VehicleTraits{},
                                                  world_.now());
  detector_ = std::make_unique<model::Detector>(world_, model_topics_, generation_, *autopilot_);
  visibility_ = std::make_unique<model::VisibilityMonitor>(world_, *autopilot_, plan_);
  battery_ = std::make_unique<model::BatteryMonitor>(world_, model_topics_, *autopilot_, plan_);
  thrusters_ = std::make_unique<model::ThrusterMonitor>(world_, *autopilot_, plan_);
  for (simulation::Node* node : world_.nodes()) node->launch();
}

void VehicleProcess::publish() {
  if (!autopilot_) return;
  poses_->publish(msg::to_message(autopilot_->vehicle().seen()));
  if (const auto centre = autopilot_->centre(); centre && !has_told_home_) {
    has_told_home_ = true;
    home_->publish(msg::to_message(*centre));
  }
  if (detector_->found() && !has_told_first_point_) {
    has_told_first_point_ = true;
    first_point_->publish({static_cast<std::int32_t>(*detector_->found())});
  }
}

}  // namespace culprit::suave
