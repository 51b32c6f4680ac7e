// The data that flow between the nodes of the model, tick by tick: physics, devices, topics, place, costmaps, status.
#include <algorithm>
#include <cmath>
#include <limits>

#include "exemplars/rover/model/rover_model.h"

namespace culprit::rover::model {
namespace {

using namespace std::chrono_literals;

constexpr Duration kTolerance =
    1s;  // transform_tolerance (tf_buffer.h), and of the controller's scan
constexpr Duration kMisfits = 1s;  // until the particles follow a scan that shows only zeros
constexpr double kFinds = 0.9;  // share of the looks into the whole map that find the right place
constexpr double kLeak = 20;    // MB a second (rover_node.h)

}  // namespace

void RoverModel::tick() {
  drive();
  sense();
  disturb();
  localize();
  show_costmaps();
  beat();
  diagnose();
  after(kTick, [this] { tick(); });
}

bool RoverModel::is_due(const Part& part, Duration period) const {
  return (now_ + part.phase).time_since_epoch() % period < kTick;
}

void RoverModel::tell_signals(const std::string& source, const Value& value) {
  const auto found = signals_.find(source);
  if (found == signals_.end()) return;
  for (const SignalId signal : found->second) tell(SignalRead{signal, value});
}

void RoverModel::publish(std::string_view component, const char* topic, const Fields& fields) {
  const auto found = ids_.find(component);  // a stray process is no component
  const ComponentId id = found != ids_.end() ? found->second : ComponentId(parts_.size());
  for (std::size_t t = 0; t < rules_.topics.size(); ++t) {
    const Topic& each = rules_.topics[t];
    if (each.name == topic && each.publisher.value_or(id) == id) tell(SampleArrived{TopicId(t), 1});
  }
  for (const auto& [field, value] : fields) tell_signals(std::string(topic) + " " + field, value);
}

// From the goal to the wheels.
void RoverModel::drive() {
  const Part& base = part("base");
  const Part& controller = part("controller_server");
  const bool in_odom = is_new(odometry_, kTolerance);
  const bool counts = works(base) && base.fault != "odom_frozen";
  const double driven = std::abs(speed_) * seconds(kTick);
  const auto wanted = trip_.step(
      now_,
      {.navigator = works("bt_navigator"),
       .planner = works("planner_server") && has_costs_,
       .controller = works(controller),
       .behavior = works("behavior_server"),
       .in_map = in_odom && is_new(corrected_, kTolerance),
       .sees = in_odom && is_new(scanned_, kTolerance) && controller.fault != "costmap_frozen",
       .is_lost = pose_error_ > kLostAt,
       .oscillates = controller.fault == "oscillate",
       .max_speed = std::get<double>(*controller.parameter("max_speed")),
       .moved = counts ? driven : 0});
  if (wanted) publish("controller_server", "/cmd_vel_nav", {{"angular.z", Value(wanted->turn)}});
  if (wanted && works("velocity_smoother")) {
    wanted_ = *wanted;
    smoothed_ = now_;
  }
  const Part& smoother = part("velocity_smoother");
  if (works(smoother)) publish("velocity_smoother", "/cmd_vel_smoothed");
  const Part& e_stop = part("e_stop");
  const bool may_drive =
      e_stop.parameter("stopped") && !std::get<bool>(*e_stop.parameter("stopped"));
  if (works(e_stop)) released_ = may_drive ? now_ : kLongAgo;
  Trip::Command command;
  if (works(smoother) && smoother.fault != "best_effort" && works("twist_mux")) {
    if (is_new(smoothed_, 1s) && is_new(released_, 1s)) command = wanted_;
    publish("twist_mux", "/cmd_vel",
            {{"linear.x", Value(command.speed)}, {"angular.z", Value(command.turn)}});
  }
  const bool has_power = std::get<bool>(*base.parameter("motor_power"));
  const bool moves = works(base) && has_power && base.fault != "stall";
  wheels_ = moves ? command.speed : 0;
  speed_ = base.fault == "slip" ? 0 : wheels_;
  place_ += speed_ * seconds(kTick);
  turn_ = moves ? command.turn : 0;
  const bool stands = std::abs(speed_) < 0.02 && std::abs(turn_) < 0.05;
  if (stands) stood_s_ += seconds(kTick);
  if (!stands) moved_ = now_;
  if (!counts) pose_error_ += driven / 2;  // the scan corrects the other half
  const Part& navigator = part("bt_navigator");
  if (!trip_.take_news() || !navigator.can_answer()) return;
  for (const Input& input : rules_.inputs) {
    if (input.kind == Input::Kind::kGoals) return tell(GoalsSeen{input.topic, trip_.goals()});
  }
}

// The drivers.
void RoverModel::sense() {
  const Part& lidar = part("lidar");
  const bool is_slow = lidar.fault == "slow";
  const bool is_out = flaps_since_ != kNever && (now_ - flaps_since_) % 4s < 3s;
  if (works(lidar) && is_plugged_ && !is_out && lidar.fault != "stall" &&
      is_due(lidar, is_slow ? 500ms : 100ms)) {
    if (lidar.fault != "frozen") frozen_range_ = 0.5 + random_.uniform();
    const bool is_nan = lidar.fault == "nan";
    const bool is_zero = lidar.fault == "zeros";
    const double nothing = is_nan ? std::numeric_limits<double>::quiet_NaN() : 0.0;
    const bool is_ours = lidar.fault != "wrong_frame";
    if (is_ours) scanned_ = now_;
    publish("lidar", "/scan",
            {{"min(ranges)", Value(is_nan || is_zero ? nothing : frozen_range_)},
             {"max(ranges)", Value(is_nan || is_zero ? nothing : 6.0)},
             {"header.frame_id", Value(is_ours ? "laser" : "lazer")}});
  }
  const Part& camera = part("camera");
  const bool is_long = works(camera) && std::get<double>(*camera.parameter("exposure")) > 1;
  if (works(camera) && camera.fault != "stall" && is_due(camera, is_long ? 2s : 250ms)) {
    publish("camera", "/camera/image_raw");
    if (works("cloud_maker") && part("cloud_maker").fault != "stall") ++clouds_;
  }
  const Part& imu = part("imu");
  if (works(imu) && imu.fault != "stall")
    publish("imu", "/imu",
            {{"angular_velocity.z", Value(turn_ + (imu.fault == "bias" ? 0.5 : 0.0))}});
  const Part& base = part("base");
  if (!works(base)) return;
  const bool is_frozen = base.fault == "odom_frozen";
  const bool is_late = base.fault == "tf_late" || base.fault == "clock_jump";
  publish("base", "/odom",
          {{"twist.twist.angular.z", Value(is_frozen ? 0.0 : turn_)},
           {"twist.twist.linear.x", Value(is_frozen ? 0.0 : wheels_)},
           {"delay(header.stamp)", Value(is_late ? 3.0 : 0.01)}});
  if (base.fault != "tf_stopped") publish("base", "/tf");
  if (base.fault != "tf_stopped" && !is_late) odometry_ = now_;
  if (is_due(base, 1s)) publish("base", "/battery_state", {{"percentage", Value(charge_)}});
}

// Processes that somebody started beside the robot's.
void RoverModel::disturb() {
  if (strays_.contains("lidar_driver") && is_due(part("lidar"), 100ms)) publish("lidar", "/scan");
  const bool has_base = strays_.contains("base_driver");
  if (has_base) publish("base", "/odom");
  if (has_base) publish("base", "/tf");
  if (strays_.contains("ekf")) publish("ekf", "/tf");
  // amcl takes each jump for a motion.
  if (has_base || strays_.contains("ekf")) pose_error_ = std::max(pose_error_, 2.0);
}

// amcl, and where it believes to be.
void RoverModel::localize() {
  const Part& amcl = part("amcl");
  const Part& lidar = part("lidar");
  if (works(amcl) && works("map_server")) has_map_ = true;
  if (part("planner_server").is_in_graph && works("map_server")) has_costs_ = true;
  const bool has_scan = scanned_ == now_;
  const bool in_odom = is_new(odometry_, kTolerance);
  if (!works(amcl) || !has_map_ || !has_scan || !in_odom || amcl.fault == "stall") return;
  const bool fits = lidar.fault != "zeros" && lidar.fault != "nan";
  if (fits) misfit_ = kNever;
  if (!fits && misfit_ == kNever) misfit_ = now_;
  if (lidar.fault == "zeros" && now_ > later(misfit_, kMisfits))
    pose_error_ = std::max(pose_error_, 2.0);
  if (fits && std::exchange(looks_everywhere_, false) && random_.chance(kFinds)) pose_error_ = 0.05;
  const bool is_lost = pose_error_ > kLostAt;
  if (fits && !is_lost) pose_error_ = std::max(0.05, pose_error_ * 0.9);
  const bool is_frozen = lidar.fault == "frozen" && speed_ > 0.1;
  match_ = !fits || is_lost ? 0.35 : is_frozen ? 0.6 : 0.95;
  publish("amcl", "/amcl_pose",
          {{"pose.pose.position.x", Value(place_)}, {"pose.pose.position.y", Value(0.0)}});
  if (amcl.fault == "tf_stopped") return;
  publish("amcl", "/tf");
  corrected_ = now_;
}

void RoverModel::show_costmaps() {
  const Part& planner = part("planner_server");
  if (works(planner) && has_costs_ && planner.fault != "costmap_frozen" && is_due(planner, 1s))
    publish("planner_server", "/global_costmap/costmap");
  const Part& controller = part("controller_server");
  if (works(controller) && controller.fault != "costmap_frozen" && is_due(controller, 500ms) &&
      is_new(odometry_, kTolerance))
    publish("controller_server", "/local_costmap/costmap");
}

// The bonds, and the managers that watch them.
void RoverModel::beat() {
  for (const Group& group : rules_.groups) {
    BondManager& manager = *managers_.at(group.manager);
    for (std::size_t s = 0; s < group.members.size(); ++s) {
      const Part& server = parts_[group.members[s].index];
      if (works(server) && is_due(server, 1s)) manager.on_bond(s, now_);
    }
    const Part& process = parts_[group.manager.index];
    if (process.can_answer()) manager.step(now_);
  }
}

// Each node's status, and the usage of processes, each second.
void RoverModel::diagnose() {
  const Part& amcl = part("amcl");
  if (works(amcl) && has_map_ && is_due(amcl, 1s)) tell_signals("amcl match", Value(match_));
  const Part& cloud_maker = part("cloud_maker");
  if (works(cloud_maker) && is_due(cloud_maker, 1s))
    tell_signals("cloud_maker clouds", Value(std::exchange(clouds_, 0.0)));
  Part& camera = part("camera");
  if (!works(camera) || !is_due(camera, 1s)) return;
  tell_signals("camera_driver brightness", Value(camera.fault == "dark"  ? 0.0
                                                 : camera.fault == "dim" ? 8.0
                                                                         : 60.0));
  if (camera.fault == "leak") camera.memory_mib += kLeak;
  tell(UsageSeen{ids_.at("camera"), 0.02, camera.memory_mib});
}

}  // namespace culprit::rover::model
