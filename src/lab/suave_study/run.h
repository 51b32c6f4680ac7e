// One run of the SUAVE study: a mission, and what it yields.
#pragma once

#include <string>
#include <vector>

#include "exemplars/suave/model/suave_model.h"
#include "manager/managing_system.h"
#include "suave_study/track.h"

namespace culprit::study {

struct SuaveRun {
  // As the exemplar counts.
  double search_s = 0;    // whole seconds; of a pipeline that was not found, the whole mission
  double distance_m = 0;  // inspected since the inspection began the last time
  suave::model::Reactions visibility;
  suave::model::Reactions thruster;
  suave::model::Reactions battery;

  // Honestly.
  bool is_found = false;
  double found_s = 0;           // not cut to seconds; if it was not found, the time searched
  double whole_distance_m = 0;  // also what was inspected before an interruption
  bool is_success = false;      // found, inspected for 10 m at least, and never out of power

  bool operator==(const SuaveRun&) const = default;
};

// All that happened in a mission.
struct SuaveTelling {
  Track track;
  std::vector<Event> events;  // that the manager told; those of others tell nothing
  Time begin;                 // of the mission, since the robot was started
  Time end;
};

inline constexpr const char* kCulprit = "culprit";

// Who manages: the baselines (managers/suave_manager.h); other planners with culprit's rules
// (managers/style_planner.h); and culprit.
struct SuaveContender {
  std::string name;
  std::string summary;
};
std::vector<SuaveContender> suave_contenders();

// Has it culprit's rules, and so events to report?
bool has_rules(const std::string& contender);

// The rules that culprit has in such a mission.
const RuleSet& rules_for(const suave::model::MissionPlan& plan);

// Plays a mission. `manager` is a contender's name. The same seed gives the same run, with or
// without a recording.
SuaveRun play_suave(const std::string& manager, const suave::model::Generation& generation,
                    const suave::model::MissionPlan& plan,
                    const suave::model::VehicleTraits& vehicle, std::uint64_t seed,
                    SuaveTelling* telling = nullptr);

}  // namespace culprit::study
