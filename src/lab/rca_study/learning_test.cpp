#include "rca_study/learning.h"

#include <cmath>

#include <gtest/gtest.h>

#include "json/json.h"
#include "rca_study/learning_report.h"

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
  return *learn({.setting = {4, 1, 0, false},
                 .faults = 120,
                 .forgetting = forgetting,
                 .has_drift = has_drift},
                nullptr);
}

TEST(Learning, ComesNearTheTruth) {
  const LearningResult result = learned(false, 1);
  EXPECT_EQ(result.learned, 120u);
  EXPECT_EQ(result.measured, 480u);
  EXPECT_LT(result.success.error(), 0.06) << "of a few hundred outcomes, by chance 0.03";
  EXPECT_LT(result.kappa.error(), 0.06);
}

// The standard error of a rate over this many outcomes.
double standard_error(double rate, double outcomes) {
  return std::sqrt(rate * (1 - rate) / std::max(1.0, outcomes));
}

// A rate that was measured to be 0 or 1 may be a little off that.
double cautious(double rate, double outcomes) { return (rate * outcomes + 2) / (outcomes + 4); }

// Does the paper's planner learn, and how many faults come at once?
class LearningWith : public testing::TestWithParam<std::pair<bool, std::size_t>> {};

TEST_P(LearningWith, FindsTheTrueRatesWhateverWasBelievedAtFirst) {
  const auto [uses_paper_planner, faults] = GetParam();
  for (const Priors priors : {Priors::kRight, Priors::kOff, Priors::kFlat}) {
    const LearningResult result = *learn({.setting = {4, faults, 0, false},
                                          .uses_paper_planner = uses_paper_planner,
                                          .priors = priors,
                                          .faults = 300},
                                         nullptr);
    int judged = 0;
    for (const LearnedRate& rate : result.strategies) {
      if (rate.judged < 100) continue;
      ++judged;
      const double of_prior = 10 * std::abs(rate.prior - rate.truth()) / (10 + rate.counted);
      EXPECT_LE(std::abs(rate.believed - rate.truth()),
                3 * standard_error(rate.truth(), rate.judged) + of_prior)
          << rate.strategy << ", executed " << rate.executed << " times, helped " << rate.helped
          << " times; judged " << rate.judged << " times, helped " << rate.judged_helped;
    }
    EXPECT_GE(judged, 5);
  }
}

// With several faults the paper's planner repairs causes and effects side by side.
INSTANTIATE_TEST_SUITE_P(EachPlanner, LearningWith,
                         testing::Values(std::pair(false, 1), std::pair(false, 2),
                                         std::pair(true, 1), std::pair(true, 2)),
                         [](const auto& each) {
                           return (each.param.first ? "paper_" : "bayes_") +
                                  std::to_string(each.param.second);
                         });

TEST_P(LearningWith, FindsHowSurelyAFailureGoesWithItsCause) {
  const auto [uses_paper_planner, faults] = GetParam();
  int coupled = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const LearningResult result = *learn({.setting = {4, faults, 0, false},
                                          .uses_paper_planner = uses_paper_planner,
                                          .faults = 200,
                                          .seed = seed},
                                         nullptr);
    for (const LearnedCoupling& coupling : result.couplings) {
      const double truth = coupling.truth();
      if (std::min<double>(coupling.asked, coupling.counted) < 20) continue;
      ++coupled;
      const double rate = cautious(truth, coupling.asked);
      EXPECT_NEAR(coupling.learned(), truth,
                  3 * std::hypot(standard_error(rate, coupling.asked),
                                 standard_error(rate, coupling.counted)))
          << "seed " << seed << ", " << coupling.cause << " -> " << coupling.effect << ": asked "
          << coupling.asked << " times, counted " << coupling.counted;
    }
  }
  EXPECT_GE(coupled, 4);
}

TEST(Learning, FollowsADriftWithForgettingOnly) {
  const LearningResult stubborn = learned(true, 1);
  const LearningResult forgetful = learned(true, 0.97);
  EXPECT_LT(forgetful.rates.error(), stubborn.rates.error());
}

TEST(LearningReport, HasTheNumbersAndTheCommand) {
  LearningResult result;
  result.success.add(0.5, true);
  const auto json = parse_json(learning_json({}, result, "culprit study rca --learn 1", "1.0"));
  EXPECT_EQ(json["learning"]["success"]["expected_calibration_error"], 0.5);
  EXPECT_EQ(json["learning"]["success"]["bins"][0]["came_true"], 1);
  EXPECT_EQ(json["campaign"]["command"], "culprit study rca --learn 1");
}

}  // namespace
}  // namespace culprit::study::rca
