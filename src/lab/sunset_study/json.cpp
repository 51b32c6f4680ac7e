#include "sunset_study/json.h"

#include "exemplars/sunset/sunset_scenario.h"
#include "json/json.h"
#include "study/run_record.h"

namespace culprit::study {
namespace {

Json mean_sd(const Summary& summary) {
  if (summary.count() == 0) return {{"mean", nullptr}, {"sd", nullptr}};
  return {{"mean", summary.mean()}, {"sd", summary.sd()}};
}

// Inside "honest", the honest downtime needs no second adjective.
std::string_view honest_key(Metric metric) {
  return metric == Metric::kHonestDowntime ? traits(Metric::kDowntime).key : traits(metric).key;
}

Json row_json(const Row& row, std::optional<bool> is_on_front) {
  const Configuration& configuration = row.configuration;
  Json json = {{"dependencies", configuration.switches.dependencies},
               {"criticality", configuration.switches.criticality},
               {"impact", configuration.switches.impact},
               {"planner", configuration.planner},
               {"profile", configuration.profile}};
  if (configuration.probabilities == Probabilities::kMisspecified)
    json["probabilities"] = "misspecified";
  json["runs"] = row.runs;
  for (const Metric metric : kPublishedMetrics)
    json[std::string(traits(metric).key)] = mean_sd(row[metric]);
  Json honest;
  for (const Metric metric : kHonestMetrics)
    honest[std::string(honest_key(metric))] = mean_sd(row[metric]);
  honest["recovery_s"]["censored"] = row[Metric::kRecovery].censored();
  honest["on_front"] = is_on_front ? Json(*is_on_front) : Json();
  json["honest"] = std::move(honest);
  return json;
}

Json curve_json(const LearningCurve& curve) {
  Json learned = Json::array();
  for (const Moments& after : curve.learned)
    learned.push_back({{"mean", after.mean()}, {"sd", after.population_sd()}});
  return {
      {"failure", curve.failure},
      {"rule", curve.rule},
      {"strategy", curve.strategy},
      {"executed", curve.executed},
      {"counted", curve.counted},
      {"not_counted",
       {{"outage", curve.hidden}, {"repair_beside", curve.beside}, {"run_over", curve.undecided}}},
      {"cleared_of_all", curve.verdicts},
      {"initial", curve.initial},
      {"truth", curve.truth},
      {"truth_of_all", curve.truth_of_all},
      {"believed", curve.believed()},
      {"error", curve.error()},
      {"error_of_prior", curve.error_of_prior()},
      {"standard_error", curve.standard_error()},
      {"learned", std::move(learned)}};
}

}  // namespace

std::string json(const Findings& findings) {
  Json document = {{"study", Campaign::kStudy},
                   {"campaign", to_json(findings.campaign.campaign)},
                   {"scenarios", Json::array()},
                   {"rows", Json::array()}};
  for (const sunset::Scenario& each : sunset::scenarios())
    document["scenarios"].push_back(each.name());
  const auto front = on_front(findings.campaign);
  for (std::size_t i = 0; i < front.size(); ++i)
    document["rows"].push_back(row_json(findings.campaign.rows[i], front[i]));
  for (const LearningCurve& curve : findings.learning)
    document["learning"].push_back(curve_json(curve));
  // Names from outside may be no UTF-8; the rest of the document is not lost for that.
  return to_indented(document) + "\n";
}

}  // namespace culprit::study
