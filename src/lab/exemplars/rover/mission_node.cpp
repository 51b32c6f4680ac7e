// mission: sends the rover from room to room, by the action navigate_to_pose. Its status counts the goals.
#include <array>

#include "exemplars/rover/action.h"
#include "exemplars/rover/geometry.h"
#include "exemplars/rover/nodes.h"

namespace culprit::rover {
namespace {

constexpr std::array<Pose2, 6> kGoals = {
    {{2, 1.2, 0}, {2, 6, 0}, {5.9, 5.9, 0}, {10, 5.9, 0}, {10.6, 1.2, 0}, {6.2, 3.2, 0}}};

class MissionNode final : public RoverNode {
 public:
  using RoverNode::RoverNode;

 private:
  void set_up() override {
    join(client_);
    hear<ActionTypes<act::NavigateToPose>::Feedback>(
        "/navigate_to_pose/_action/feedback", rtps::qos::kDefault,
        [this](const auto&) { heard_ = ros2::Executor::Clock::now(); });
    every(500ms, [this] {
      // A navigator that was replaced does not know the goal.
      const bool is_forgotten = ros2::Executor::Clock::now() - heard_ > 6s;
      if (!client_.is_running() || is_forgotten) send();
    });
  }
  void send() {
    heard_ = ros2::Executor::Clock::now();
    client_.send({{header_now("map"), to_message(kGoals[next_])}, ""},
                 [this](auto status, const auto&) {
                   if (status == Status::kSucceeded) {
                     ++reached_;
                     next_ = (next_ + 1) % kGoals.size();
                   } else if (status) {
                     ++failed_;
                   }
                 });
  }
  std::vector<ros2::msg::KeyValue> values() override {
    return {{"goals_reached", std::to_string(reached_)}, {"goals_failed", std::to_string(failed_)}};
  }

  std::size_t next_ = 0;
  int reached_ = 0;
  int failed_ = 0;
  ros2::Executor::Clock::time_point heard_{};  // the last feedback, or the order
  ActionClient<act::NavigateToPose> client_{"/navigate_to_pose"};
};

}  // namespace

const Process kMission = {"mission", make<MissionNode>, false};

}  // namespace culprit::rover
