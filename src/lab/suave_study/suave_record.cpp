#include "suave_study/suave_record.h"

#include <algorithm>
#include <cmath>

#include "study/json_fields.h"
#include "suave_study/settings_json.h"

namespace culprit::study {
namespace {

using suave::model::Reactions;

bool is_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

bool is_finite(const SuaveRun& run) {
  bool is_finite =
      study::is_finite({run.search_s, run.distance_m, run.found_s, run.whole_distance_m});
  for (const Reactions* each : {&run.visibility, &run.thruster, &run.battery}) {
    is_finite =
        is_finite && study::is_finite(each->answered_s) && study::is_finite(each->unanswered_s);
  }
  return is_finite;
}

Json to_json(const Reactions& reactions) {
  return {{"answered_s", reactions.answered_s}, {"unanswered_s", reactions.unanswered_s}};
}

Reactions reactions(JsonFields& run, std::string_view name) {
  JsonFields fields(run.object(name));
  Reactions reactions;
  reactions.answered_s = fields.numbers("answered_s");
  reactions.unanswered_s = fields.numbers("unanswered_s");
  run.complain_inside(name, fields.complaint());
  return reactions;
}

std::vector<std::string> managers(JsonFields& campaign) {
  std::vector<std::string> managers;
  for (const Json& each : campaign.array("managers")) {
    if (!each.is_string()) campaign.complain("managers", "holds something that is no text");
    if (each.is_string()) managers.push_back(each.get<std::string>());
  }
  if (const Expected<void> known = check_managers(managers); !known)
    campaign.complain_inside("managers", known.error());
  return managers;
}

// Files of before there were any have neither: the mission was played as it is, with the fitted
// vehicle.
void take_settings(JsonFields& fields, SuaveCampaign& campaign) {
  if (fields.has("settings")) {
    auto settings = settings_from_json(fields.object("settings"));
    if (!settings) fields.complain_inside("settings", settings.error());
    if (settings && campaign.plan != nullptr && *settings != settings_of(*campaign.plan))
      campaign.settings = std::move(*settings);
  }
  if (fields.has("vehicle")) {
    auto vehicle = vehicle_from_json(fields.object("vehicle"));
    if (!vehicle) fields.complain_inside("vehicle", vehicle.error());
    if (vehicle) campaign.vehicle = *vehicle;
  }
}

}  // namespace

Expected<Json> to_json(const SuaveRun& run) {
  if (!is_finite(run)) return Error{"a metric of a run is no finite number"};
  return Json{{"search_s", run.search_s},
              {"distance_m", run.distance_m},
              {"visibility", to_json(run.visibility)},
              {"thruster", to_json(run.thruster)},
              {"battery", to_json(run.battery)},
              {"is_found", run.is_found},
              {"found_s", run.found_s},
              {"whole_distance_m", run.whole_distance_m},
              {"is_success", run.is_success}};
}

template <>
Expected<SuaveRun> run_from_json(const Json& json) {
  JsonFields fields(json);
  SuaveRun run;
  run.search_s = fields.number("search_s");
  run.distance_m = fields.number("distance_m");
  run.visibility = reactions(fields, "visibility");
  run.thruster = reactions(fields, "thruster");
  run.battery = reactions(fields, "battery");
  run.is_found = fields.truth("is_found");
  run.found_s = fields.number("found_s");
  run.whole_distance_m = fields.number("whole_distance_m");
  run.is_success = fields.truth("is_success");
  const std::string complaint = fields.complaint();
  if (!complaint.empty()) return Error{complaint};
  return run;
}

Json to_json(const SuaveCampaign& campaign) {
  return {{"command", campaign.command},
          {"mission", campaign.plan->name},
          {"generation", campaign.generation->name},
          {"managers", campaign.managers},
          {"runs", campaign.runs},
          {"seed", campaign.seed},
          {"settings", to_json(campaign.settings.value_or(settings_of(*campaign.plan)))},
          {"vehicle", to_json(campaign.vehicle)},
          {"version", campaign.version}};
}

template <>
Expected<SuaveCampaign> campaign_from_json(const Json& json) {
  JsonFields fields(json);
  SuaveCampaign campaign;
  campaign.command = fields.text("command");
  const auto plan = suave::model::find_mission_plan(fields.text("mission"));
  if (plan) campaign.plan = *plan;
  if (!plan) fields.complain_inside("mission", plan.error());
  const auto generation = suave::model::find_generation(fields.text("generation"));
  if (generation) campaign.generation = *generation;
  if (!generation) fields.complain_inside("generation", generation.error());
  campaign.managers = managers(fields);
  campaign.runs = static_cast<std::uint32_t>(fields.natural("runs", kMostShardedRuns));
  if (campaign.runs == 0) fields.complain("runs", "is 0");
  campaign.seed = fields.natural("seed", std::numeric_limits<std::uint64_t>::max());
  take_settings(fields, campaign);
  campaign.version = fields.text("version");
  const std::string complaint = fields.complaint();
  if (!complaint.empty()) return Error{complaint};
  return campaign;
}

}  // namespace culprit::study
