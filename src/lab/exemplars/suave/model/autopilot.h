// The autopilot with the vehicle under it, and the camera that looks for the pipeline.
#pragma once

#include <optional>

#include "exemplars/suave/model/members.h"
#include "exemplars/suave/model/mission_plan.h"
#include "exemplars/suave/model/pipeline.h"
#include "exemplars/suave/model/vehicle.h"

namespace culprit::suave::model {

// Takes setpoints, and knows where it is; poses are read from it, where the exemplar has a topic
// whose messages come 20 times a second.
class Autopilot : public simulation::Node {
 public:
  // Takes setpoints from `guided` on: the mission's begin, T0.
  Autopilot(simulation::World& world, Topics& topics, const VehicleTraits& traits, Time guided);

  Time guided() const { return guided_; }
  Vehicle& vehicle() { return vehicle_; }
  const Vehicle& vehicle() const { return vehicle_; }

  // Where the spiral is centred; nothing while the autopilot does not know yet where it is.
  std::optional<Position> centre() const;

  // Called after each step of the vehicle.
  std::function<void()> on_pose;

 private:
  void on_start() override;
  void step();

  Time guided_;
  Time first_pose_;
  Position centre_;
  Vehicle vehicle_;
  simulation::Publisher<Data> state_;
};

class Detector : public simulation::Node, private simulation::Watcher {
 public:
  // All must outlive the detector.
  Detector(simulation::World& world, Topics& topics, const Generation& generation,
           Autopilot& autopilot);
  ~Detector() override;

  // The pipeline's point that was seen first.
  std::optional<std::size_t> found() const { return found_; }

 private:
  void on_start() override;
  void on_diagnostic(std::string_view status, std::string_view key, const Value& value) override;
  void look();

  const Generation& generation_;
  Autopilot& autopilot_;
  simulation::Publisher<Data> detected_;
  std::optional<double> visibility_;
  std::optional<std::size_t> found_;
};

}  // namespace culprit::suave::model
