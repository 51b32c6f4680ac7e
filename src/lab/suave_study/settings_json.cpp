#include "suave_study/settings_json.h"

#include <array>

#include "study/json_fields.h"

namespace culprit::study {
namespace {

using suave::model::MissionSettings;
using suave::model::Range;
using suave::model::ThrusterSetting;
using suave::model::VehicleTraits;

struct Trait {
  const char* name;
  double VehicleTraits::*value;
};

constexpr std::array kTraits = {
    Trait{"gain_per_s", &VehicleTraits::gain_per_s},
    Trait{"cruise", &VehicleTraits::cruise},
    Trait{"climb", &VehicleTraits::climb},
    Trait{"lag_s", &VehicleTraits::lag_s},
    Trait{"drift_sd", &VehicleTraits::drift_sd},
    Trait{"drift_time_s", &VehicleTraits::drift_time_s},
    Trait{"failed_speed", &VehicleTraits::failed_speed},
    Trait{"failed_gain", &VehicleTraits::failed_gain},
    Trait{"failed_again", &VehicleTraits::failed_again},
    Trait{"centre_y", &VehicleTraits::centre_y},
    Trait{"centre_y_sd", &VehicleTraits::centre_y_sd},
    Trait{"first_pose_s", &VehicleTraits::first_pose_s},
};

Json to_json(const Range& range) {
  if (!range.turns.empty()) return {{"by_turns", range.turns}};
  return Json::array({range.low, range.high});
}

Range range(JsonFields& fields, std::string_view name) {
  if (fields.is_object(name)) {
    JsonFields own(fields.object(name));
    Range by_turns;
    by_turns.turns = own.numbers("by_turns");
    if (by_turns.turns.empty()) own.complain("by_turns", "is empty");
    fields.complain_inside(name, own.complaint());
    return by_turns;
  }
  const std::vector<double> ends = fields.numbers(name);
  if (ends.size() == 2) return {ends[0], ends[1]};
  fields.complain(name, "is no pair of numbers");
  return {};
}

ThrusterSetting thruster_event(const Json& json, JsonFields& settings) {
  JsonFields fields(json);
  ThrusterSetting event;
  event.thruster = fields.integer("thruster", 1);
  const std::string what = fields.text("event");
  event.fails = what == "fails";
  if (what != "fails" && what != "recovers")
    fields.complain("event", "is neither \"fails\" nor \"recovers\"");
  event.at_s = range(fields, "at_s");
  settings.complain_inside("thruster_events", fields.complaint());
  return event;
}

}  // namespace

Json to_json(const MissionSettings& settings) {
  Json events = Json::array();
  for (const ThrusterSetting& event : settings.thruster_events) {
    events.push_back({{"thruster", event.thruster},
                      {"event", event.fails ? "fails" : "recovers"},
                      {"at_s", to_json(event.at_s)}});
  }
  return {{"visibility_period_s", settings.visibility_period_s},
          {"visibility_shift_s", to_json(settings.visibility_shift_s)},
          {"visibility_m", Json::array({settings.least_visibility_m, settings.most_visibility_m})},
          {"thruster_events", events},
          {"start_y_m", settings.start_y_m ? to_json(*settings.start_y_m) : Json(nullptr)},
          {"time_limit_s", settings.time_limit_s}};
}

Json to_json(const VehicleTraits& vehicle) {
  Json json;
  for (const Trait& trait : kTraits) json[trait.name] = vehicle.*trait.value;
  return json;
}

Expected<MissionSettings> settings_from_json(const Json& json) {
  JsonFields fields(json);
  MissionSettings settings;
  settings.visibility_period_s = fields.number("visibility_period_s");
  settings.visibility_shift_s = range(fields, "visibility_shift_s");
  const Range visibility = range(fields, "visibility_m");
  if (!visibility.turns.empty()) fields.complain("visibility_m", "is no pair of numbers");
  settings.least_visibility_m = visibility.low;
  settings.most_visibility_m = visibility.high;
  for (const Json& event : fields.array("thruster_events"))
    settings.thruster_events.push_back(thruster_event(event, fields));
  if (!fields.is_null("start_y_m")) settings.start_y_m = range(fields, "start_y_m");
  settings.time_limit_s = fields.number("time_limit_s");
  const std::string complaint = fields.complaint();
  if (!complaint.empty()) return Error{complaint};
  if (auto possible = check(settings); !possible) return Error{possible.error()};
  return settings;
}

Expected<VehicleTraits> vehicle_from_json(const Json& json) {
  JsonFields fields(json);
  VehicleTraits vehicle;
  for (const Trait& trait : kTraits) {
    vehicle.*trait.value = fields.number(trait.name);
    if (vehicle.*trait.value < 0) fields.complain(trait.name, "is negative");
  }
  const std::string complaint = fields.complaint();
  if (!complaint.empty()) return Error{complaint};
  return vehicle;
}

}  // namespace culprit::study
