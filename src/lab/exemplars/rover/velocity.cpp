// velocity_smoother and twist_mux: from what the controller wants to what the base is told.
#include <algorithm>

#include "exemplars/rover/geometry.h"
#include "exemplars/rover/nodes.h"

namespace culprit::rover {
namespace {

// velocity_smoother: limits the acceleration, 20 Hz, from /cmd_vel_nav to /cmd_vel_smoothed. Stops 1 s after the last command.
class VelocitySmoother final : public RoverNode {
 public:
  explicit VelocitySmoother(Settings settings)
      : RoverNode({.name = "/velocity_smoother", .is_managed = true}, settings) {}

 private:
  void set_up() override {
    offer(out_, "/cmd_vel_smoothed");
    hear<msg::Twist>("/cmd_vel_nav", ros2::qos::kDefault, [this](const msg::Twist& twist) {
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
    out_->publish(given_);
  }

  msg::Twist wanted_;
  msg::Twist given_;
  ros2::Executor::Clock::time_point heard_{};
  std::optional<ros2::Publisher<msg::Twist>> out_;
};

// twist_mux: a person's command goes before that of the navigation, 0.5 s long. While `stopped` is set it says stop: the safe stop.
class TwistMux final : public RoverNode {
 public:
  explicit TwistMux(Settings settings)
      : RoverNode({.name = "/twist_mux", .parameters = {{"stopped", false}}}, settings) {}

 private:
  void set_up() override {
    offer(out_, "/cmd_vel");
    hear<msg::Twist>("/cmd_vel_joy", ros2::qos::kDefault, [this](const msg::Twist& twist) {
      by_hand_ = ros2::Executor::Clock::now();
      pass(twist);
    });
    hear<msg::Twist>("/cmd_vel_smoothed", ros2::qos::kDefault, [this](const msg::Twist& twist) {
      if (ros2::Executor::Clock::now() - by_hand_ > 500ms) pass(twist);
    });
  }
  void pass(const msg::Twist& twist) {
    out_->publish(parameter<bool>("stopped") ? msg::Twist{} : twist);
  }

  ros2::Executor::Clock::time_point by_hand_{};
  std::optional<ros2::Publisher<msg::Twist>> out_;
};

}  // namespace

std::unique_ptr<RoverNode> make_velocity_smoother(Settings settings) {
  return std::make_unique<VelocitySmoother>(std::move(settings));
}
std::unique_ptr<RoverNode> make_twist_mux(Settings settings) {
  return std::make_unique<TwistMux>(std::move(settings));
}

}  // namespace culprit::rover
