#include "study/rca/learning.h"

#include <gtest/gtest.h>

#include "study/rca/learning_report.h"

namespace culprit::study::rca {
namespace {

TEST(Calibration, ErrorIsTheMeanDistanceOfItsBins) {
  Calibration calibration;
  EXPECT_EQ(calibration.error(), 0);
  for (int i = 0; i < 4; ++i) calibration.add(0.25, i == 0);  // as was said
  for (int i = 0; i < 4; ++i) calibration.add(1, i > 0);      // a quarter too much
  EXPECT_EQ(calibration.count(), 8);
  EXPECT_DOUBLE_EQ(calibration.error(), 0.125);
  EXPECT_EQ(calibration.bins()[9].forecast.count(), 4) << "certainty is in the last bin";
}

LearningResult learned(bool has_drift, double forgetting) {
  LearningCampaign campaign;
  campaign.setting = {4, 1, 0, false};
  campaign.faults = 120;
  campaign.has_drift = has_drift;
  campaign.forgetting = forgetting;
  return *learn(campaign, nullptr);
}

TEST(Learning, ComesNearTheTruth) {
  const LearningResult result = learned(false, 1);
  EXPECT_EQ(result.learned, 120u);
  EXPECT_EQ(result.measured, 480u);
  EXPECT_LT(result.success.error(), 0.06) << "of a few hundred outcomes, by chance 0.03";
  EXPECT_LT(result.kappa.error(), 0.06);
}

TEST(Learning, FollowsADriftWithForgettingOnly) {
  const LearningResult stubborn = learned(true, 1);
  const LearningResult forgetful = learned(true, 0.97);
  EXPECT_LT(forgetful.rates.error(), stubborn.rates.error());
}

TEST(LearningReport, HasThePlotsAndTheNumbers) {
  LearningCampaign campaign;
  LearningResult result;
  result.success.add(0.5, true);
  const std::string page = learning_html(campaign, result, "culprit study rca --learn 1", "1.0");
  EXPECT_NE(page.find("expected calibration error 0.500 of 1 outcomes"), std::string::npos);
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_NE(learning_json(campaign, result).find("\"expected_calibration_error\": 0.5"),
            std::string::npos);
}

}  // namespace
}  // namespace culprit::study::rca
