// One process of the live robot: the vehicle under its autopilot, the camera that looks for the
// pipeline, and the monitors of water, battery and thrusters. The nodes are the model's.
//
// The mission begins with a call of services::kStart.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "exemplars/suave/bridge.h"
#include "exemplars/suave/live_names.h"
#include "exemplars/suave/model/autopilot.h"
#include "exemplars/suave/model/monitors.h"
#include "exemplars/suave/paced_world.h"
#include "exemplars/suave/position_messages.h"

namespace culprit::suave {

class VehicleProcess {
 public:
  VehicleProcess(NodeOptions options, const model::Generation& generation,
                 const model::MissionPlan& plan);

  // The context outlives the process.
  Expected<void> open(ros2::Context& context);

 private:
  Expected<void> open_nodes(ros2::Context& context);
  Expected<void> open_topics();
  Expected<void> open_services();
  Expected<void> declare_servos();
  void begin();
  void publish();

  const NodeOptions options_;
  const model::Generation& generation_;
  const model::MissionPlan& plan_;
  simulation::World world_;
  model::Topics model_topics_;

  // From begin() on.
  std::unique_ptr<model::Autopilot> autopilot_;
  std::unique_ptr<model::Detector> detector_;
  std::unique_ptr<model::VisibilityMonitor> visibility_;
  std::unique_ptr<model::BatteryMonitor> battery_;
  std::unique_ptr<model::ThrusterMonitor> thrusters_;
  bool has_told_home_ = false;
  bool has_told_first_point_ = false;

  std::vector<std::unique_ptr<ros2::Node>> nodes_;  // the autopilot's first
  std::unique_ptr<Bridge> bridge_;
  std::optional<ros2::Publisher<msg::PoseStamped>> poses_;
  std::optional<ros2::Publisher<msg::PoseStamped>> home_;
  std::optional<ros2::Publisher<ros2::msg::Int32>> first_point_;
  std::unique_ptr<ros2::Subscription> setpoints_;
  std::vector<std::unique_ptr<ros2::ServiceServer>> services_;
  std::optional<PacedWorld> pace_;
};

}  // namespace culprit::suave
