// A mission's settings and a vehicle as JSON: in shard files, in what a campaign found, and in
// files of their own.
//
//     {"visibility_period_s": 80, "visibility_shift_s": [0, 120], "visibility_m": [1.25, 3.75],
//      "thruster_events": [{"thruster": 1, "event": "fails", "at_s": [35, 35]}],
//      "start_y_m": {"by_turns": [2.8, 3.15]}, "time_limit_s": 300}
//     Where a pair stands, another value is drawn from between in each run, but of visibility_m.
//
//     {"gain_per_s": 0.65, "cruise": 0.7625, ...}     each of VehicleTraits
#pragma once

#include "exemplars/suave/model/mission_settings.h"
#include "exemplars/suave/model/vehicle.h"
#include "json/json.h"

namespace culprit::study {

Json to_json(const suave::model::MissionSettings& settings);
Json to_json(const suave::model::VehicleTraits& vehicle);

// Errors: a field is missing, unknown, or no value that a mission or a vehicle can have.
Expected<suave::model::MissionSettings> settings_from_json(const Json& json);
Expected<suave::model::VehicleTraits> vehicle_from_json(const Json& json);

}  // namespace culprit::study
