// Settings of a mission that a campaign may change: the water, the thrusters, the place and the
// duration (the exemplar's mission_config.yaml and its runner's perturbations).
//
//     MissionSettings settings = settings_of(plan);
//     settings.visibility_shift_s = {0, 120};                    // another one in each run
//     MissionPlan of_this_run = drawn(plan, settings, seed, run);
//
// A range is drawn from uniformly in each run; one without width is a constant. Turns are lists
// that the exemplar's runner had drawn: run i takes the i-th value of each list, and starts over
// after the last.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "exemplars/suave/model/mission_plan.h"

namespace culprit::suave::model {

struct Range {
  double low = 0;
  double high = 0;
  std::vector<double> turns{};  // not empty: one of these instead, by the number of the run

  bool operator==(const Range&) const = default;
};

struct ThrusterSetting {
  int thruster = 1;  // 1 to kThrusters
  bool fails = true;
  Range at_s;  // after the mission's begin, 0 or more

  bool operator==(const ThrusterSetting&) const = default;
};

struct MissionSettings {
  double visibility_period_s = 80;
  Range visibility_shift_s;
  double least_visibility_m = 1.25;
  double most_visibility_m = 3.75;
  std::vector<ThrusterSetting> thruster_events;
  // Where a run begins, across the pipeline, in m; nothing: as the vehicle's traits say.
  std::optional<Range> start_y_m;
  double time_limit_s = 300;

  bool operator==(const MissionSettings&) const = default;
};

// As `plan` has them.
MissionSettings settings_of(const MissionPlan& plan);

// The plan of one run. The same seed and number, the same plan.
MissionPlan drawn(const MissionPlan& plan, const MissionSettings& settings, std::uint64_t seed,
                  std::uint32_t run);

// Errors: a number that no mission can have (a period or limit of 0 s, a thruster that does not
// exist, ...).
Expected<void> check(const MissionSettings& settings);

// "35", "0..120", or, by turns, "35,60,47.5".
Expected<Range> parse_range(std::string_view text);
// "1:fails@35", "3:recovers@0..200".
Expected<ThrusterSetting> parse_thruster(std::string_view text);

// The text that is parsed so.
std::string to_string(const Range& range);
std::string to_string(const ThrusterSetting& event);

}  // namespace culprit::suave::model
