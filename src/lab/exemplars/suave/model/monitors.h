// The robot's diagnostics: the water's visibility, the battery, the thrusters. Each has a timer of
// one second, with a phase of its own, from the mission's begin on.
#pragma once

#include "exemplars/suave/model/autopilot.h"

namespace culprit::suave::model {

class VisibilityMonitor : public simulation::Node {
 public:
  VisibilityMonitor(simulation::World& world, const Autopilot& autopilot, const MissionPlan& plan);

 private:
  void on_start() override;

  const Autopilot& autopilot_;
  const MissionPlan& plan_;
};

class BatteryMonitor : public simulation::Node {
 public:
  BatteryMonitor(simulation::World& world, Topics& topics, Autopilot& autopilot,
                 const MissionPlan& plan);

  double level() const { return level_; }
  bool ran_empty() const { return ran_empty_; }
  // battery_monitor/recharge: full at once.
  void recharge();

 private:
  void on_start() override;
  void discharge();
  void tell();

  Autopilot& autopilot_;
  const MissionPlan& plan_;
  simulation::Publisher<Data> recharged_;
  double level_ = 1;
  bool ran_empty_ = false;
};

class ThrusterMonitor : public simulation::Node {
 public:
  ThrusterMonitor(simulation::World& world, Autopilot& autopilot, const MissionPlan& plan);

 private:
  void on_start() override;
  void check();

  Autopilot& autopilot_;
  const MissionPlan& plan_;
  std::size_t next_ = 0;  // of the plan's events
};

}  // namespace culprit::suave::model
