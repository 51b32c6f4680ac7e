// Which SUAVE is modelled, and what goes wrong in it: generation and mission.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/expected.h"
#include "simulation/fault.h"

namespace culprit::suave::model {

// The differences between the exemplar's versions, as far as they change a run.
struct Generation {
  std::string_view name;
  std::string_view summary;
  double pipeline_height = 0;     // above the seabed, for the detection, m
  Duration detection_poll{};      // of the mission, whether the pipeline was detected
  Duration recharge_poll{};       // whether the station is reached
  bool tells_undetected = false;  // also while the pipeline is not seen
  bool keeps_spiral = true;       // over a deactivation of the search
  bool loses_point = true;        // of the path, where following it is interrupted
  bool recovers_anyway = true;    // a recovery goes on when it is switched off
};

// "era" (versions 1.3 and 1.4, of which the published figures are), "new" (1.5).
std::span<const Generation> generations();
Expected<const Generation*> find_generation(std::string_view name);

struct ThrusterEvent {
  int thruster = 1;  // from 1
  bool fails = true;
  Duration at{};  // whole seconds after the mission's begin
};

struct MissionPlan {
  std::string_view name;
  std::string_view summary;
  Duration time_limit = std::chrono::seconds(300);
  double visibility_period_s = 80;  // of the cosine that the water clears and dims by
  double visibility_shift_s = 0;    // how far it is when the mission begins
  double least_visibility_m = 1.25;
  double most_visibility_m = 3.75;
  std::optional<double> start_y_m;  // instead of the vehicle's traits
  std::vector<ThrusterEvent> thruster_events;
  bool needs_battery = false;             // a manager is expected to see to it
  bool stops_when_empty = false;          // an empty battery ends all motion
  std::vector<simulation::Fault> faults;  // their times count from the mission's begin
};

// "standard" and "extended" as published, and "stress", ours.
std::span<const MissionPlan> mission_plans();
Expected<const MissionPlan*> find_mission_plan(std::string_view name);

}  // namespace culprit::suave::model
