// The helm of a function that runs in a process of its own: the rest of the robot is reached over
// DDS.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "exemplars/suave/model/helm.h"
#include "exemplars/suave/position_messages.h"
#include "ros2/node.h"
#include "ros2/services.h"

namespace culprit::suave {

// Everything on the executor's thread.
class LiveHelm : public model::Helm {
 public:
  // The node outlives the helm.
  static Expected<std::unique_ptr<LiveHelm>> create(ros2::Node& node);

  model::Position seen() const override { return seen_; }
  void go_to(const model::Position& goal) override;
  std::optional<model::Position> centre() const override { return centre_; }
  std::optional<std::size_t> found() const override { return found_; }
  void recover(int thruster) override;
  void recharge() override;

 private:
  LiveHelm() = default;
  Expected<void> open(ros2::Node& node);
  Expected<void> subscribe(ros2::Node& node);

  model::Position seen_;
  std::optional<model::Position> centre_;
  std::optional<std::size_t> found_;
  std::optional<ros2::Publisher<msg::PoseStamped>> setpoints_;
  std::vector<std::unique_ptr<ros2::Subscription>> subscriptions_;
  std::unique_ptr<ros2::Client<ros2::srv::SetParameters>> autopilot_;
  std::unique_ptr<ros2::Client<ros2::srv::Trigger>> battery_;
};

}  // namespace culprit::suave
