#include "study/run_record.h"

#include <algorithm>
#include <cmath>

#include "study/json_fields.h"

namespace culprit::study {
namespace {

constexpr std::size_t kMostRows = 256;

Json to_json(const HonestMetrics& honest) {
  const RootCauses& causes = honest.root_causes;
  return {{"downtime_s", honest.downtime_s},
          {"strategies", honest.strategies},
          {"faults", honest.faults},
          {"wrong_component", honest.wrong_component},
          {"unresolved", honest.unresolved},
          {"recovery_s", honest.recovery_s},
          {"is_recovery_censored", honest.is_recovery_censored},
          {"root_causes",
           {{"asked", causes.asked}, {"top", causes.top_right}, {"exact", causes.exact_right}}}};
}

RootCauses root_causes(const Json& json, std::string& complaint) {
  JsonFields fields(json);
  RootCauses causes;
  causes.asked = fields.integer("asked", 0);
  causes.top_right = fields.integer("top", 0);
  causes.exact_right = fields.integer("exact", 0);
  if (causes.top_right > causes.asked || causes.exact_right > causes.asked)
    fields.complain("asked", "is less than what was right");
  complaint = fields.complaint();
  return causes;
}

HonestMetrics honest_metrics(const Json& json, std::string& complaint) {
  JsonFields fields(json);
  HonestMetrics honest;
  honest.downtime_s = fields.number("downtime_s");
  honest.strategies = fields.integer("strategies", 0);
  honest.faults = fields.integer("faults", 0);
  honest.wrong_component = fields.integer("wrong_component", 0);
  honest.unresolved = fields.integer("unresolved", 0);
  honest.recovery_s = fields.number("recovery_s");
  honest.is_recovery_censored = fields.truth("is_recovery_censored");
  std::string inside;
  honest.root_causes = root_causes(fields.object("root_causes"), inside);
  fields.complain_inside("root_causes", inside);
  complaint = fields.complaint();
  return honest;
}

Json to_json(const Configuration& configuration) {
  return {{"dependencies", configuration.switches.dependencies},
          {"criticality", configuration.switches.criticality},
          {"impact", configuration.switches.impact},
          {"planner", configuration.planner},
          {"profile", configuration.profile},
          {"misspecified", configuration.probabilities == Probabilities::kMisspecified}};
}

Configuration configuration(const Json& json, std::string& complaint) {
  JsonFields fields(json);
  Configuration configuration;
  configuration.switches.dependencies = fields.truth("dependencies");
  configuration.switches.criticality = fields.truth("criticality");
  configuration.switches.impact = fields.truth("impact");
  configuration.planner = fields.text("planner");
  configuration.profile = fields.text("profile");
  configuration.probabilities =
      fields.truth("misspecified") ? Probabilities::kMisspecified : Probabilities::kIdeal;
  complaint = fields.complaint();
  return configuration;
}

std::vector<Configuration> rows(const Json& json, std::string& complaint) {
  std::vector<Configuration> rows;
  if (json.size() > kMostRows) {
    complaint = "it has more than " + std::to_string(kMostRows) + " entries";
    return rows;
  }
  for (const Json& row : json) {
    std::string inside;
    rows.push_back(configuration(row, inside));
    if (complaint.empty()) complaint = inside;
    if (std::find(rows.begin(), rows.end() - 1, rows.back()) != rows.end() - 1)
      complaint = "a configuration is there twice";
    if (!complaint.empty()) break;
  }
  if (json.empty()) complaint = "it is empty";
  return rows;
}

bool is_finite(const RunMetrics& run) {
  return std::isfinite(run.ratio) && std::isfinite(run.downtime_s) &&
         std::isfinite(run.honest.downtime_s) && std::isfinite(run.honest.recovery_s) &&
         std::all_of(run.reactions_s.begin(), run.reactions_s.end(),
                     [](double value) { return std::isfinite(value); });
}

}  // namespace

Expected<Json> to_json(const RunMetrics& run) {
  if (!is_finite(run)) return Error{"a metric of a run is no finite number"};
  return Json{{"is_left_out", run.is_left_out},
              {"ratio", run.ratio},
              {"reactions_s", run.reactions_s},
              {"downtime_s", run.downtime_s},
              {"unnecessary_redeployments", run.unnecessary_redeployments},
              {"honest", to_json(run.honest)}};
}

template <>
Expected<RunMetrics> run_from_json(const Json& json) {
  JsonFields fields(json);
  RunMetrics run;
  run.is_left_out = fields.truth("is_left_out");
  run.ratio = fields.number("ratio");
  run.reactions_s = fields.numbers("reactions_s");
  run.downtime_s = fields.number("downtime_s");
  run.unnecessary_redeployments = fields.integer("unnecessary_redeployments");
  std::string inside;
  run.honest = honest_metrics(fields.object("honest"), inside);
  fields.complain_inside("honest", inside);
  const std::string complaint = fields.complaint();
  if (!complaint.empty()) return Error{complaint};
  return run;
}

Json to_json(const Campaign& campaign) {
  Json rows = Json::array();
  for (const Configuration& row : campaign.rows) rows.push_back(to_json(row));
  return {{"command", campaign.command},
          {"seed", campaign.seed},
          {"runs", campaign.runs},
          {"rows", std::move(rows)},
          {"version", campaign.version}};
}

template <>
Expected<Campaign> campaign_from_json(const Json& json) {
  JsonFields fields(json);
  Campaign campaign;
  campaign.command = fields.text("command");
  campaign.seed = fields.natural("seed", std::numeric_limits<std::uint64_t>::max());
  campaign.runs = static_cast<std::uint32_t>(fields.natural("runs", kMostShardedRuns));
  if (campaign.runs == 0) fields.complain("runs", "is 0");
  campaign.version = fields.text("version");
  std::string inside;
  campaign.rows = rows(fields.array("rows"), inside);
  fields.complain_inside("rows", inside);
  const std::string complaint = fields.complaint();
  if (!complaint.empty()) return Error{complaint};
  return campaign;
}

}  // namespace culprit::study
