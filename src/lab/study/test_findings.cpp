#include "study/test_findings.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "study/published.h"

namespace culprit::study {
namespace {

// About N(0, 1), and the same everywhere.
double normal(std::mt19937& engine) {
  double sum = -6;
  for (int i = 0; i < 12; ++i) sum += static_cast<double>(engine()) * 0x1p-32;
  return sum;
}

double around(const published::MeanSd& value, std::mt19937& engine) {
  return value.mean + value.sd * normal(engine);
}

LearningCurve synthetic_curve(std::string failure, std::string rule, std::string strategy,
                              double initial, double truth) {
  LearningCurve curve{
      std::move(failure), std::move(rule), std::move(strategy), initial, truth, {}, 162};
  curve.counted = curve.executed;
  curve.truth_of_all = truth;
  curve.planner = "paper";
  std::mt19937 engine(static_cast<unsigned>(truth * 1000));
  double alpha = 10 * initial;
  double beta = 10 - alpha;
  for (int i = 0; i < 162; ++i) {
    (static_cast<double>(engine()) * 0x1p-32 < truth ? alpha : beta) += 1;
    Moments after;
    after.add(alpha / (alpha + beta) - 0.01);
    after.add(alpha / (alpha + beta) + 0.01);
    curve.learned.push_back(after);
  }
  return curve;
}

Timeline synthetic_timeline(std::uint32_t run) {
  return {{{true, true, true}, "paper", "paper", Probabilities::kIdeal},
          run,
          "image_degradation+camera_driver_issue",
          {{5.0, Happening::kFault, "camera", "camera_driver_issue goes in"},
           {5.2, Happening::kFault, "camera", "autofocus_needed goes in"},
           {8.7, Happening::kFailure, "camera", "RGBDead detected (ERROR)"},
           {8.7, Happening::kFailure, "sensor_fusion", "SensorFusionDead detected (ERROR)"},
           {8.7, Happening::kBlame, "camera", "camera is held responsible <for> both & more"},
           {8.8, Happening::kAdaptation, "camera", "restart camera"},
           {9.9, Happening::kGaveUp, "camera", "restart camera did not help"},
           {10.0, Happening::kAdaptation, "camera", "redeploy camera"},
           {12.4, Happening::kResolved, "camera", "RGBDead resolved"},
           {12.4, Happening::kResolved, "sensor_fusion", "SensorFusionDead went away"},
           {13.0, Happening::kNote, "", "all is well"}}};
}

}  // namespace

Campaign synthetic_campaign(std::uint32_t runs) {
  Campaign campaign;
  for (const published::Result& result : published::ablation())
    campaign.rows.push_back({result.switches, "paper", "paper", result.probabilities});
  campaign.rows.push_back({{true, true, true}, "paper", "paper", Probabilities::kMisspecified});
  campaign.runs = runs;
  campaign.seed = 42;
  campaign.version = "0.0-test";
  campaign.command = "SYNTHETIC DATA OF A TEST, NOT MEASURED";
  return campaign;
}

RunMetrics synthetic_run(const Configuration& configuration, RunId id) {
  std::seed_seq sequence{id.row, id.run};
  std::mt19937 engine(sequence);
  const published::Values means = *published::values_of(configuration);
  RunMetrics run;
  run.ratio = std::max(0.0, around(means[0], engine));
  for (int i = 0; i < 3; ++i) run.reactions_s.push_back(std::max(0.1, around(means[1], engine)));
  run.downtime_s = std::max(0.0, around(means[2], engine));
  run.unnecessary_redeployments = static_cast<std::int32_t>(std::lround(around(means[3], engine)));
  HonestMetrics& honest = run.honest;
  honest.downtime_s = run.downtime_s + 0.3;
  honest.faults = 3;
  honest.strategies = static_cast<std::int32_t>(2 + engine() % 5);
  honest.wrong_component = static_cast<std::int32_t>(engine() % 3);
  honest.unresolved = static_cast<std::int32_t>(engine() % 8 == 0);
  honest.is_recovery_censored = honest.unresolved > 0;
  honest.recovery_s = honest.is_recovery_censored ? 20 : run.downtime_s + 1;
  honest.root_causes = {2, static_cast<std::int32_t>(engine() % 3), 0};
  return run;
}

CampaignResult synthetic_result(std::uint32_t runs) {
  const Campaign campaign = synthetic_campaign(runs);
  CampaignFold fold(campaign);
  while (!fold.is_complete()) {
    const RunId id = campaign[fold.size()];
    fold.add(synthetic_run(campaign.rows[id.row], id));
  }
  return std::move(fold).result();
}

Findings synthetic_findings(std::uint32_t runs) {
  return {synthetic_result(runs),
          {synthetic_curve("F1", "RGBDead", "rgb_restart", 0.32, 0.4),
           synthetic_curve("F1", "RGBDead", "rgb_redeploy", 0.48, 0.6),
           synthetic_curve("F4", "SegmentationBad", "recalibration", 0.64, 0.8),
           synthetic_curve("F4", "SegmentationBad", "enhancement_activate", 0.12, 0.1),
           synthetic_curve("F4", "SegmentationBad", "enhancement_deactivate", 0.12, 0.1)},
          {synthetic_timeline(0), synthetic_timeline(37)}};
}

}  // namespace culprit::study
