// SUAVE as a discrete-event model: the managed system of the paper's second evaluation, in robot
// time.
//
// An underwater robot searches a pipeline in a spiral and then follows it, while the water gets
// murky, thrusters fail and the battery runs low. A manager repairs that by changing the modes of
// its functions.
#pragma once

#include "exemplars/suave/model/functions.h"
#include "exemplars/suave/model/metrics.h"
#include "exemplars/suave/model/monitors.h"

namespace culprit::suave::model {

class SuaveModel : private Helm {
 public:
  struct Setting {
    const Generation& generation;
    const MissionPlan& plan;
    Leader leader = Leader::kMission;
    VehicleTraits vehicle = {};
  };

  // Starts all nodes. All objects in `setting` must outlive the model. The same seed, the same run.
  SuaveModel(const Setting& setting, std::uint64_t seed);
  SuaveModel(const SuaveModel&) = delete;
  SuaveModel& operator=(const SuaveModel&) = delete;

  simulation::World& world() { return world_; }
  const MissionPlan& plan() const { return plan_; }
  Time guided() const { return autopilot_.guided(); }  // the mission's begin
  // The mission is over by then at the latest.
  Time latest_end() const;
  Mission& mission() { return mission_; }
  const Vehicle& vehicle() const { return autopilot_.vehicle(); }
  const BatteryMonitor& battery() const { return battery_; }
  Metrics& metrics() { return metrics_; }

 private:
  Position seen() const override { return autopilot_.vehicle().seen(); }
  void go_to(const Position& goal) override { autopilot_.vehicle().go_to(goal); }
  std::optional<Position> centre() const override { return autopilot_.centre(); }
  std::optional<std::size_t> found() const override { return detector_.found(); }
  void recover(int thruster) override { autopilot_.vehicle().set_failed(thruster, false); }
  void recharge() override { battery_.recharge(); }

  const MissionPlan& plan_;
  simulation::World world_;
  Topics topics_;
  Autopilot autopilot_;
  Detector detector_;
  VisibilityMonitor visibility_;
  BatteryMonitor battery_;
  ThrusterMonitor thrusters_;
  SearchNode search_;
  FollowNode follow_;
  MotionNode motion_;
  RechargeNode recharge_;
  simulation::ModeManager modes_;
  Mission mission_;
  Metrics metrics_;
};

}  // namespace culprit::suave::model
