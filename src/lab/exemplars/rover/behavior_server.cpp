// behavior_server: the actions spin and backup, for recoveries.
#include "exemplars/rover/action.h"
#include "exemplars/rover/nodes.h"
#include "exemplars/rover/tf_buffer.h"

namespace culprit::rover {
namespace {

class BehaviorServer final : public RoverNode {
 public:
  using RoverNode::RoverNode;

 private:
  void set_up() override {
    offer(twist_, "/cmd_vel_nav");
    hear<msg::TFMessage>("/tf", {.depth = 100}, [this](const auto& tf) { tf_.add(tf); });
    join(spin_);
    join(back_up_);
    every(100ms, [this] { move(); });
  }
  void on_deactivate() override { finish(Status::kAborted); }

  bool begin(const msg::Twist& command, double amount) {
    if (!is_active() || spin_.is_running() || back_up_.is_running()) return false;
    command_ = command;
    ticks_left_ = static_cast<int>(10 * std::abs(amount));
    return true;
  }

  void move() {
    if (!spin_.is_running() && !back_up_.is_running()) return;
    if (spin_.is_cancelled() || back_up_.is_cancelled()) return finish(Status::kCanceled);
    if (!tf_.in_odom()) return finish(Status::kAborted);
    if (ticks_left_-- <= 0) return finish(Status::kSucceeded);
    twist_->publish(command_);
  }
  void finish(Status status) {
    if (!spin_.is_running() && !back_up_.is_running()) return;
    twist_->publish(msg::Twist{});
    spin_.end(status);
    back_up_.end(status);
  }

  TfBuffer tf_;
  msg::Twist command_;
  int ticks_left_ = 0;
  ActionServer<act::Spin> spin_{"/spin", [this](const act::Spin::Goal& goal) {
                                  return begin(to_twist(0, 1),
                                               static_cast<double>(goal.target_yaw));
                                }};
  ActionServer<act::BackUp> back_up_{"/backup", [this](const act::BackUp::Goal& goal) {
                                       return begin(to_twist(-0.15, 0), goal.target.x / 0.15);
                                     }};
  std::optional<ros2::Publisher<msg::Twist>> twist_;
};

}  // namespace

const Process kBehaviorServer = {"behavior_server", make<BehaviorServer>};

}  // namespace culprit::rover
