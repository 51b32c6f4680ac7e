// bt_navigator: the action navigate_to_pose, as Nav2's default tree (navigate_to_pose_w_replanning_and_recovery):
//
//   each second: compute_path_to_pose, then follow_path with the new path
//   if one of them fails: back up, spin, wait, in turn, and try again; after six recoveries the goal is aborted
#include "exemplars/rover/action.h"
#include "exemplars/rover/nodes.h"
#include "exemplars/rover/tf_buffer.h"

namespace culprit::rover {
namespace {

class BtNavigator final : public RoverNode {
 public:
  using RoverNode::RoverNode;

 private:
  using Clock = ros2::Executor::Clock;
  enum class Doing : std::uint8_t { kNothing, kPlanning, kFollowing, kRecovering };

  void set_up() override {
    hear<msg::TFMessage>("/tf", {.depth = 100}, [this](const auto& tf) { tf_.add(tf); });
    join(action_);
    join(plan_);
    join(follow_);
    join(spin_);
    join(back_up_);
    every(100ms, [this] { tick(); });
  }
  void on_deactivate() override { finish(Status::kAborted); }

  bool accept(const act::NavigateToPose::Goal& goal) {
    if (!is_active()) return false;
    goal_ = goal.pose;
    recoveries_ = 0;
    begun_ = Clock::now();
    doing_ = Doing::kPlanning;
    due_ = begun_;
    return true;
  }

  void tick() {
    if (!action_.is_running()) return;
    if (action_.is_cancelled()) return finish(Status::kCanceled);
    const auto now = Clock::now();
    if (++ticks_ % 10 == 0) feed_back();
    if (now < due_) return;
    switch (doing_) {
      case Doing::kNothing:
        return;
      case Doing::kPlanning:
      case Doing::kFollowing:
        return plan_.is_running() ? recover() : plan();  // no answer until it was due
      case Doing::kRecovering:
        doing_ = Doing::kPlanning;
        return;
    }
  }

  void plan() {
    due_ = Clock::now() + 3s;
    plan_.send({goal_, {}, "GridBased", false}, [this](auto status, const auto& result) {
      if (status != Status::kSucceeded) return recover();
      follow(result.path);
    });
  }
  void follow(const msg::Path& path) {
    doing_ = Doing::kFollowing;
    due_ = Clock::now() + 1s;
    follow_.send({path, "FollowPath", "goal_checker"}, [this](auto status, const auto&) {
      if (status == Status::kSucceeded) return finish(Status::kSucceeded);
      recover();
    });
  }
  void recover() {
    plan_.cancel();
    follow_.cancel();
    if (++recoveries_ > 6) return finish(Status::kAborted);
    doing_ = Doing::kRecovering;
    due_ = Clock::now() + (recoveries_ % 3 == 0 ? 2s : 5s);
    const auto go_on = [this](auto, const auto&) { due_ = Clock::now(); };
    if (recoveries_ % 3 == 1) back_up_.send({{0.3, 0, 0}, 0.15F, {}}, go_on);
    if (recoveries_ % 3 == 2) spin_.send({1.57F, {}}, go_on);
  }
  void finish(Status status) {
    plan_.cancel();
    follow_.cancel();
    spin_.cancel();
    back_up_.cancel();
    doing_ = Doing::kNothing;
    action_.end(status);
  }

  void feed_back() {
    act::NavigateToPose::Feedback feedback;
    const auto robot = tf_.in_map();
    if (!robot) return;
    feedback.current_pose = {header_now("map"), to_message(*robot)};
    feedback.navigation_time.sec = static_cast<std::int32_t>(
        std::chrono::floor<std::chrono::seconds>(Clock::now() - begun_).count());
    feedback.number_of_recoveries = static_cast<std::int16_t>(recoveries_);
    feedback.distance_remaining = static_cast<float>(distance(*robot, to_pose(goal_.pose)));
    action_.feed_back(feedback);
  }

  TfBuffer tf_;
  msg::PoseStamped goal_;
  Doing doing_ = Doing::kNothing;
  Clock::time_point begun_{};
  Clock::time_point due_{};  // of the next step, at the latest
  int recoveries_ = 0;
  int ticks_ = 0;
  ActionServer<act::NavigateToPose> action_{"/navigate_to_pose",
                                            [this](const auto& goal) { return accept(goal); }};
  ActionClient<act::ComputePathToPose> plan_{"/compute_path_to_pose"};
  ActionClient<act::FollowPath> follow_{"/follow_path"};
  ActionClient<act::Spin> spin_{"/spin"};
  ActionClient<act::BackUp> back_up_{"/backup"};
};

}  // namespace

const Process kBtNavigator = {"bt_navigator", make<BtNavigator>};

}  // namespace culprit::rover
