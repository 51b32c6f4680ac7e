// velocity_smoother, twist_mux and e_stop: from what the controller wants to what the base is told.
#include <algorithm>

#include "exemplars/rover/geometry.h"
#include "exemplars/rover/nodes.h"

namespace culprit::rover {
namespace {

// velocity_smoother: limits the acceleration, 20 Hz, from /cmd_vel_nav to /cmd_vel_smoothed. Stops 1 s after the last command.
//
// Fault: "best_effort" (its publisher has another QoS, and so the reliable twist_mux hears nothing).
class VelocitySmoother final : public RoverNode {
 public:
  using RoverNode::RoverNode;

 private:
  void set_up() override {
    offer(out_, "/cmd_vel_smoothed");
    hear<msg::Twist>("/cmd_vel_nav", rtps::qos::kDefault, [this](const msg::Twist& twist) {
      wanted_ = twist;
      heard_ = ros2::Executor::Clock::now();
    });
    every(50ms, [this] { smooth(); });
  }
  void on_deactivate() override { given_ = wanted_ = {}; }

  void smooth() {
    if (ros2::Executor::Clock::now() - heard_ > 1s) wanted_ = {};
    const auto toward = [](double from, double to, double most) {
      return from + std::clamp(to - from, -most, most);
    };
    given_.linear.x = toward(given_.linear.x, wanted_.linear.x, 0.08);
    given_.angular.z = toward(given_.angular.z, wanted_.angular.z, 0.3);
    if (has("best_effort") && !std::exchange(is_best_effort_, true))
      offer(out_, "/cmd_vel_smoothed", rtps::qos::kSensorData);
    if (out_) out_->publish(given_);
  }

  bool is_best_effort_ = false;
  msg::Twist wanted_;
  msg::Twist given_;
  ros2::Executor::Clock::time_point heard_{};
  std::optional<ros2::Publisher<msg::Twist>> out_;
};

// twist_mux: a person's command goes before that of the navigation, 0.5 s long. While /e_stop says so, or is silent for 1 s, it says
// stop: a lock, as twist_mux calls it.
class TwistMux final : public RoverNode {
 public:
  using RoverNode::RoverNode;

 private:
  using Clock = ros2::Executor::Clock;

  void set_up() override {
    offer(out_, "/cmd_vel");
    hear<msg::Twist>("/cmd_vel_joy", rtps::qos::kDefault, [this](const msg::Twist& twist) {
      by_hand_ = Clock::now();
      pass(twist);
    });
    hear<msg::Twist>("/cmd_vel_smoothed", rtps::qos::kDefault, [this](const msg::Twist& twist) {
      if (Clock::now() - by_hand_ > 500ms) pass(twist);
    });
    hear<ros2::msg::Bool>("/e_stop", rtps::qos::kDefault, [this](const ros2::msg::Bool& stop) {
      if (!stop.data) released_ = Clock::now();
      if (stop.data) released_ = {};
    });
  }
  void pass(const msg::Twist& twist) {
    out_->publish(Clock::now() - released_ < 1s ? twist : msg::Twist{});
  }

  Clock::time_point by_hand_{};
  Clock::time_point released_{};  // the last time that /e_stop allowed to drive
  std::optional<ros2::Publisher<msg::Twist>> out_;
};

// e_stop: the safe stop. /e_stop says at 5 Hz whether the rover must stand: the parameter `stopped`.
class EStop final : public RoverNode {
 public:
  explicit EStop(Settings settings) : RoverNode(settings, {.parameters = {{"stopped", false}}}) {}

 private:
  void set_up() override {
    offer(out_, "/e_stop");
    every(200ms, [this] { publish(parameter<bool>("stopped")); });
  }
  // At once, not with the next tick.
  Expected<void> on_set(const ros2::msg::Parameter& change) override {
    if (out_ && change.name == "stopped") publish(change.value.bool_value);
    return {};
  }
  void publish(bool stopped) { out_->publish({stopped}); }

  std::optional<ros2::Publisher<ros2::msg::Bool>> out_;
};

}  // namespace

const Process kVelocitySmoother = {"velocity_smoother", make<VelocitySmoother>};
const Process kTwistMux = {"twist_mux", make<TwistMux>};
const Process kEStop = {"e_stop", make<EStop>};

}  // namespace culprit::rover
