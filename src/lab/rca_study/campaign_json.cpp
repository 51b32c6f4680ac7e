#include "rca_study/campaign_json.h"

#include <algorithm>

#include "rca_study/scenario_json.h"
#include "study/json_fields.h"

namespace culprit::study::rca {
namespace {

// As culprit study rca has them.
constexpr std::size_t kMostFaults = 10;
constexpr double kMostNoise = 0.4;
constexpr std::uint32_t kMostEpisodes = 1'000'000;
constexpr std::size_t kMostSettings = 256;
constexpr std::size_t kMostPlanners = 64;

Json to_json(const RcaSetting& setting) {
  Json json{{"components", setting.components},
            {"faults", setting.faults},
            {"noise", setting.noise},
            {"cyclic", setting.is_cyclic},
            {"mixed_levels", setting.has_mixed_levels},
            {"flapping", setting.is_flapping},
            {"unfixable", setting.has_unfixable},
            {"ignore", setting.ignores_plumbing}};
  if (setting.factors != RcaFactors()) json["factors"] = to_json(setting.factors);
  return json;
}

RcaSetting setting(const Json& json, std::string& complaint) {
  JsonFields fields(json);
  RcaSetting setting;
  setting.components = fields.natural("components", kMostComponents);
  if (setting.components < 2) fields.complain("components", "is less than 2");
  setting.faults = fields.natural("faults", std::min(kMostFaults, setting.components));
  setting.noise = fields.number("noise");
  if (setting.noise < 0 || setting.noise > kMostNoise)
    fields.complain("noise", "is not between 0 and 0.4");
  setting.is_cyclic = fields.truth("cyclic");
  // Campaigns that were written before there was a choice have none of these.
  const auto option = [&](std::string_view name) { return fields.has(name) && fields.truth(name); };
  setting.has_mixed_levels = option("mixed_levels");
  setting.is_flapping = option("flapping");
  setting.has_unfixable = option("unfixable");
  setting.ignores_plumbing = option("ignore");
  if (fields.has("factors")) {
    const auto factors = factors_from_json(fields.object("factors"));
    if (factors) setting.factors = *factors;
    if (!factors) fields.complain_inside("factors", factors.error());
  }
  complaint = fields.complaint();
  return setting;
}

std::vector<RcaSetting> settings(JsonFields& campaign) {
  std::vector<RcaSetting> settings;
  const Json& all = campaign.array("settings");
  if (all.empty() || all.size() > kMostSettings)
    campaign.complain("settings", "has no entry, or too many");
  for (const Json& each : all) {
    std::string inside;
    settings.push_back(setting(each, inside));
    campaign.complain_inside("settings", inside);
    if (!inside.empty()) break;
  }
  return settings;
}

std::vector<std::string> planners(JsonFields& campaign) {
  std::vector<std::string> planners;
  const Json& all = campaign.array("planners");
  if (all.empty() || all.size() > kMostPlanners)
    campaign.complain("planners", "has no entry, or too many");
  for (const Json& each : all) {
    const std::string name = each.is_string() ? each.get<std::string>() : "";
    if (const auto complaint = complaint_about_planner(name)) {
      campaign.complain_inside("planners", *complaint);
      break;
    }
    planners.push_back(name);
  }
  return planners;
}

// Its setting follows from the scenario.
void take_scenario(RcaCampaign& campaign, JsonFields& fields) {
  (void)fields.array("settings");
  auto scenario = scenario_from_json(to_line(fields.object("scenario")));
  if (!scenario) return fields.complain_inside("scenario", scenario.error());
  campaign.settings = {setting_of(*scenario)};
  campaign.scenario = std::move(*scenario);
}

}  // namespace

Json to_json(const RcaCampaign& campaign) {
  Json json{{"settings", Json::array()},
            {"planners", campaign.planners},
            {"objective", to_string(campaign.objective)},
            {"episodes", campaign.episodes},
            {"seed", campaign.seed},
            {"version", campaign.version}};
  for (const RcaSetting& each : campaign.settings) json["settings"].push_back(to_json(each));
  if (campaign.scenario) json["scenario"] = parse_json(to_json(*campaign.scenario));
  return json;
}

Expected<RcaCampaign> campaign_from_json(const Json& json) {
  JsonFields fields(json);
  RcaCampaign campaign;
  if (json.is_object() && json.contains("scenario")) {
    take_scenario(campaign, fields);
  } else {
    campaign.settings = settings(fields);
  }
  campaign.planners = planners(fields);
  const auto objective = parse_objective(fields.text("objective"));
  if (objective) campaign.objective = *objective;
  if (!objective) fields.complain_inside("objective", objective.error());
  campaign.episodes = static_cast<std::uint32_t>(fields.natural("episodes", kMostEpisodes));
  if (campaign.episodes == 0) fields.complain("episodes", "is 0");
  campaign.seed = fields.natural("seed", UINT64_MAX);
  campaign.version = fields.text("version");
  const auto& asked = campaign.planners;
  if (std::find(asked.begin(), asked.end(), "optimum") != asked.end() && !has_optimum(campaign))
    fields.complain("planners", "has the optimum, which is not known of such robots");
  if (const std::string complaint = fields.complaint(); !complaint.empty()) return Error{complaint};
  return campaign;
}

}  // namespace culprit::study::rca
