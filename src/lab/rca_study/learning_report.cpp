#include "rca_study/learning_report.h"

#include <cmath>

#include <fmt/core.h>

#include "json/json.h"
#include "study/markup.h"
#include "study/plot/scale.h"
#include "study/plot/svg.h"
#include "study/report/page.h"

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

// Observed over predicted frequency; on the dotted line both agree. The larger a circle, the more
// forecasts it stands for.
Svg calibration_plot(const std::string& what, const Calibration& calibration) {
  constexpr double kSize = 340;
  const Scale x{0, 1, 50, kSize - 20};
  const Scale y{0, 1, kSize - 44, 16};
  Svg svg(kSize, kSize, "Calibration of " + what,
          "Share that came true over the probability that was forecast, in ten bins.");
  for (const double tick : ticks(0, 1, 5)) {
    svg.line({x(0), y(tick)}, {x(1), y(tick)}, "grid");
    svg.text({x(0) - 8, y(tick) + 4}, Anchor::kEnd, "small", tick_label(tick));
    svg.text({x(tick), y(0) + 18}, Anchor::kMiddle, "small", tick_label(tick));
  }
  svg.line({x(0), y(0)}, {x(1), y(0)}, "axis");
  svg.line({x(0), y(0)}, {x(1), y(1)}, "truth0");
  svg.text({x(1), y(0) + 36}, Anchor::kEnd, "small", "forecast; upwards: came true");
  std::vector<Point> line;
  for (const Calibration::Bin& bin : calibration.bins()) {
    if (bin.forecast.count() == 0) continue;
    line.push_back({x(bin.forecast.mean()), y(bin.outcome.mean())});
    const double share = static_cast<double>(bin.forecast.count()) /
                         static_cast<double>(std::max<std::int64_t>(1, calibration.count()));
    svg.circle(line.back(), 2 + 10 * std::sqrt(share), "ours");
  }
  svg.polyline(line, "curve0");
  return svg;
}

std::string figure(const std::string& id, const std::string& what, const Calibration& calibration) {
  return fmt::format(
             "<figure id=\"{}\">\n<figcaption><strong>{}</strong>: expected calibration error "
             "{:.3f} of {} outcomes</figcaption>\n",
             id, markup_escaped(what), calibration.error(), calibration.count()) +
         calibration_plot(what, calibration).inside_page() + "</figure>\n";
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

std::string learning_json(const LearningCampaign& campaign, const LearningResult& result) {
  Json document = {{"learning",
                    {{"components", campaign.setting.components},
                     {"faults_learned", result.learned},
                     {"faults_measured", result.measured},
                     {"forgetting", campaign.forgetting},
                     {"drift", campaign.has_drift},
                     {"success", json_of(result.success)},
                     {"kappa", json_of(result.kappa)},
                     {"rate_error", result.rates.error()}}}};
  if (campaign.setting.factors != RcaFactors())
    document["learning"]["factors"] = to_json(campaign.setting.factors);
  return to_indented(document) + "\n";
}

std::string learning_html(const LearningCampaign& campaign, const LearningResult& result,
                          const std::string& command, const std::string& version) {
  const std::string title = "Learning on one robot";
  return page_head(title) + "<body>\n<header>\n<h1>" + title +
         "</h1>\n<p>What was believed just before an outcome, beside what came true. On the dotted "
         "line all is as was said; the larger a circle, the more outcomes.</p>\n"
         "<dl class=\"facts\">\n" +
         page_fact("Command", "<code>" + markup_escaped(command) + "</code>") +
         page_fact("Version", "culprit " + markup_escaped(version)) +
         page_fact("Robot",
                   fmt::format("{} components, {} faults at once{}", campaign.setting.components,
                               campaign.setting.faults, other_factors(campaign))) +
         page_fact(
             "Learned from",
             fmt::format("{} faults{}", result.learned,
                         campaign.has_drift ? "; what helps changed for the last quarter" : "")) +
         page_fact("Measured on", fmt::format("{} faults after these", result.measured)) +
         page_fact("Each strategy", fmt::format("{:.3f} from how often it helped, in the mean",
                                                result.rates.error())) +
         page_fact("Forgetting", fmt::format("{:g}", campaign.forgetting)) +
         "</dl>\n</header>\n<main>\n<section>\n" +
         figure("success", "Success of strategies", result.success) +
         figure("kappa", "Failures that go away with another (kappa)", result.kappa) +
         "</section>\n</main>\n</body>\n</html>\n";
}

}  // namespace culprit::study::rca
