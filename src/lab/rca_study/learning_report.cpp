#include "rca_study/learning_report.h"

#include <fmt/core.h>

#include "json/json.h"

namespace culprit::study::rca {
namespace {

Json json_of(const Calibration& calibration) {
  Json bins = Json::array();
  for (const Calibration::Bin& bin : calibration.bins()) {
    if (bin.forecast.count() == 0) continue;
    bins.push_back({{"forecast", bin.forecast.mean()},
                    {"came_true", bin.outcome.mean()},
                    {"count", bin.forecast.count()}});
  }
  return {{"expected_calibration_error", calibration.error()},
          {"outcomes", calibration.count()},
          {"bins", std::move(bins)}};
}

// ", detectors 0 to 3 s late"; empty if it is a usual robot.
std::string other_factors(const LearningCampaign& campaign) {
  const std::string factors = describe(campaign.setting.factors);
  return factors.empty() ? "" : ", " + factors;
}

}  // namespace

std::string learning_text(const LearningCampaign& campaign, const LearningResult& result) {
  return fmt::format(
      "Learned from {} faults on a robot of {} components{}, measured on {} more{}\n"
      "  success of strategies: expected calibration error {:.3f} of {} outcomes\n"
      "  of each strategy:      {:.3f} from how often it helped, in the mean\n"
      "  kappa:                 expected calibration error {:.3f} of {} outcomes\n",
      result.learned, campaign.setting.components, other_factors(campaign), result.measured,
      campaign.has_drift ? "; what helps changed for the last quarter of the former" : "",
      result.success.error(), result.success.count(), result.rates.error(), result.kappa.error(),
      result.kappa.count());
}

std::string learning_json(const LearningCampaign& campaign, const LearningResult& result,
                          const std::string& command, const std::string& version) {
  Json document = {{"campaign", {{"command", command}, {"version", version}}},
                   {"learning",
                    {{"components", campaign.setting.components},
                     {"faults", campaign.setting.faults},
                     {"faults_learned", result.learned},
                     {"faults_measured", result.measured},
                     {"forgetting", campaign.forgetting},
                     {"drift", campaign.has_drift},
                     {"success", json_of(result.success)},
                     {"kappa", json_of(result.kappa)},
                     {"rate_error", result.rates.error()}}}};
  if (campaign.setting.factors != RcaFactors()) {
    document["learning"]["factors"] = to_json(campaign.setting.factors);
    document["learning"]["factors_in_words"] = describe(campaign.setting.factors);
  }
  return to_indented(document) + "\n";
}

}  // namespace culprit::study::rca
