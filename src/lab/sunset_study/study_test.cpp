// The claims about culprit on SUNSET (docs/planning.md), on fewer runs than there.
#include "sunset_study/study.h"

#include <cmath>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text_file.h"
#include "exemplars/sunset/model/sunset_model.h"
#include "language/checker.h"
#include "manager/runtime.h"
#include "plan/bayes/bayes_planner.h"
#include "simulation/simulated_robot.h"
#include "study/campaign_result.h"
#include "sunset_study/detectors.h"

namespace culprit::study {
namespace {

constexpr PaperSwitches kFull;
constexpr PaperSwitches kWithoutImpact{true, true, false};

CampaignResult played(std::vector<Configuration> rows, std::uint32_t runs) {
  const auto study = SunsetStudy::make(rows, 1);
  CampaignFold fold({std::move(rows), runs, 1, "", ""});
  const Campaign campaign = fold.result().campaign;
  for (std::uint64_t i = 0; i < campaign.size(); ++i) fold.add(study->run(campaign[i]));
  return std::move(fold).result();
}

TEST(SunsetClaims, BalancedIsBetterThanThePapersFullConfigurationInEveryHonestMetric) {
  const CampaignResult result = played({{kFull, "paper"}, {kFull, "bayes"}}, 162);
  for (const Metric metric : {Metric::kHonestDowntime, Metric::kStrategiesPerFault,
                              Metric::kWrongComponent, Metric::kRecovery})
    EXPECT_LT(result.rows[1][metric].mean(), result.rows[0][metric].mean()) << traits(metric).key;
  EXPECT_LE(result.rows[1][Metric::kUnresolved].mean(), result.rows[0][Metric::kUnresolved].mean());
  EXPECT_EQ(on_front(result), (std::vector<std::optional<bool>>{false, true}));
}

// Its nearest among the paper's configurations is the one that ignores impact.
TEST(SunsetClaims, TheDowntimeObjectiveHasTheLowestDowntime) {
  const CampaignResult result = played({{kWithoutImpact, "paper"}, {kFull, "bayes:downtime"}}, 324);
  EXPECT_LT(result.rows[1][Metric::kHonestDowntime].mean(),
            result.rows[0][Metric::kHonestDowntime].mean());
  EXPECT_LT(result.rows[1][Metric::kStrategiesPerFault].mean(),
            result.rows[0][Metric::kStrategiesPerFault].mean());
}

TEST(SunsetStudy, HasNoManagerForTheLiveRobotThatNeedsAModel) {
  for (const char* planner : {"reference", "oracle"})
    EXPECT_FALSE(SunsetStudy::make({{kFull, planner, std::string(kLiveRobot)}}, 1)) << planner;
  const auto study = SunsetStudy::make({{kFull, "bayes", std::string(kLiveRobot)}}, 1);
  ASSERT_TRUE(study) << study.error();
  EXPECT_EQ(study->profile(0).name, kModelOfLiveRobot);
}

TEST(SunsetClaims, AnOracleIsABound) {
  for (const char* profile : {"live", "live:phi"}) {
    SCOPED_TRACE(profile);
    const CampaignResult result =
        played({{kFull, "oracle", profile}, {kFull, "bayes:downtime", profile}}, 54);
    const Row& oracle = result.rows[0];
    const Row& bayes = result.rows[1];
    EXPECT_EQ(oracle[Metric::kWrongComponent].mean(), 0);
    EXPECT_EQ(oracle[Metric::kUnresolved].mean(), 0);
    EXPECT_LE(oracle[Metric::kStrategiesPerFault].mean(), 1);
    EXPECT_LT(oracle[Metric::kHonestDowntime].mean(), 0.5);
    EXPECT_LT(bayes[Metric::kHonestDowntime].mean(), 1.5);
    EXPECT_EQ(bayes[Metric::kWrongComponent].mean(), 0);
  }
}

// A planner that knows at once which component failed, but not the remedy.
TEST(SunsetClaims, AgesComeNearAManagerThatKnowsEachFaultAtOnce) {
  for (const std::string profile : {"live", "paper"}) {
    SCOPED_TRACE(profile);
    const CampaignResult result = played({{kFull, "oracle", profile + ":known"},
                                          {kFull, "bayes:downtime", profile + ":known"},
                                          {kFull, "bayes:downtime", profile + ":age"},
                                          {kFull, "bayes:downtime", profile + ":phi"}},
                                         162);
    const auto downtime = [&](std::size_t row) {
      return result.rows[row][Metric::kHonestDowntime].mean();
    };
    EXPECT_GT(downtime(1), downtime(0));
    // In 1,620 runs 1.50 times as long (docs/planning.md); the rest is chance.
    EXPECT_LT(downtime(2), 1.6 * downtime(1));
    EXPECT_LT(downtime(3), 1.6 * downtime(1));
  }
}

// Beliefs that are 20 % off at first come near the true rates, as in the paper's figure.
// Three standard errors. A truth of 0 or 1 has no error of its own; what it was measured on has.
double by_chance(const LearningCurve& curve, double series) {
  const double outcomes = series * curve.counted + 4;
  const double rate = (curve.truth * (outcomes - 4) + 2) / outcomes;
  return 3 * std::sqrt(rate * (1 - rate) / outcomes);
}

class WhatIsLearned : public testing::TestWithParam<std::tuple<const char*, const char*>> {};

TEST_P(WhatIsLearned, OfAStrategyThatIsLearnedFromOftenIsHowOftenItHelps) {
  const auto [planner, profile] = GetParam();
  const auto study =
      SunsetStudy::make({{kFull, planner, profile, Probabilities::kMisspecified}}, 1);
  constexpr std::uint32_t kSeries = 2;
  int judged = 0;
  for (const LearningCurve& curve : study->learn(400, kSeries, nullptr)) {
    EXPECT_NEAR(curve.executed, curve.counted + curve.hidden + curve.beside + curve.undecided, 0.01)
        << curve.strategy << ": each execution is learned from, or there is a reason";
    if (curve.strategy == "autofocus") {
      EXPECT_GT(curve.counted, 0);
    }
    if (curve.executed < 50) continue;
    EXPECT_LE(curve.error(), 0.1) << curve.strategy << ": " << curve.believed() << ", true "
                                  << curve.truth;
    if (curve.counted < 50) continue;
    ++judged;
    EXPECT_LE(curve.error(), curve.error_of_prior() + by_chance(curve, kSeries))
        << curve.strategy << ": " << curve.believed() << ", true " << curve.truth;
  }
  EXPECT_GE(judged, 3);
}

// As many experiments as the paper has; what the designer believed is still to be seen then.
TEST_P(WhatIsLearned, AfterAsManyExperimentsAsInThePaperIsOffByItsPriorOnly) {
  const auto [planner, profile] = GetParam();
  const auto study =
      SunsetStudy::make({{kFull, planner, profile, Probabilities::kMisspecified}}, 1);
  constexpr std::uint32_t kSeries = 2;
  int executed = 0;
  for (const LearningCurve& curve : study->learn(162, kSeries, nullptr)) {
    if (curve.executed < 50 || curve.counted == 0) continue;
    ++executed;
    const double off = curve.error() - curve.error_of_prior();
    EXPECT_LE(off, 0.1) << curve.strategy << ": " << curve.believed() << ", true " << curve.truth;
    EXPECT_LE(off, by_chance(curve, kSeries)) << curve.strategy;
  }
  EXPECT_GE(executed, 2);
}

INSTANTIATE_TEST_SUITE_P(OfEachPlannerAndProfile, WhatIsLearned,
                         testing::Combine(testing::Values("paper", "bayes"),
                                          testing::Values("paper", "head", "october", "live")),
                         [](const auto& each) {
                           return std::string(std::get<0>(each.param)) + "_" +
                                  std::get<1>(each.param);
                         });

// The failures that all rules together report of a healthy robot.
int failures_in_an_hour(const std::string& profile, const std::string& text) {
  const RuleSet rules = *check(Source("study.rules", text)).rules;
  sunset::model::SunsetModel model(**sunset::model::find_profile(profile), 1);
  const Time begin{model.profile().manager_start};
  model.world().run(begin);
  Manager::Options options;
  options.start = begin;
  Manager manager(rules, std::make_unique<BayesPlanner>(), options);
  simulation::SimulatedRobot robot(rules, model.world());
  Runtime runtime(manager, robot);
  int failures = 0;
  runtime.on_events = [&](std::span<const Event> events) {
    for (const Event& event : events)
      failures += std::holds_alternative<FailureDetected>(event.what) ? 1 : 0;
  };
  const std::atomic<bool> never = false;
  const Time end = later(begin, std::chrono::hours(1));
  runtime.run(never, end);
  const auto& last = manager.knowledge().signals.rhythm(TopicId(0)).last;
  EXPECT_TRUE(last && *last > end - std::chrono::seconds(1)) << "it still runs";
  return failures;
}

TEST(Detectors, RaiseNoFalseAlarmInAnHour) {
  const auto text = read_text("rules/sunset.rules");
  ASSERT_TRUE(text) << text.error();
  for (const char* profile : {"live", "paper"}) {
    EXPECT_EQ(failures_in_an_hour(profile, *text), 0) << profile;
    EXPECT_EQ(failures_in_an_hour(profile, with_phi(*text)), 0) << profile;
  }
}

TEST(Detectors, AreNamedBehindTheProfile) {
  EXPECT_EQ(*parse_profile("paper"), std::pair(std::string("paper"), Detectors::kOwn));
  EXPECT_EQ(*parse_profile("head:age"), std::pair(std::string("head"), Detectors::kAge));
  EXPECT_EQ(*parse_profile("live:phi"), std::pair(std::string("live"), Detectors::kPhi));
  EXPECT_EQ(*parse_profile("live:known"), std::pair(std::string("live"), Detectors::kKnown));
  EXPECT_EQ(parse_profile("live:eye").error(),
            "there are no detectors 'eye'; there are own, age, phi, known");
  EXPECT_FALSE(SunsetStudy::make({{kFull, "reference", "paper:age"}}, 1));
}

TEST(Detectors, TheFaultsTakeThePlaceOfAgesButOfAComponentThatHasNone) {
  const auto text = read_text("rules/sunset.rules");
  ASSERT_TRUE(text) << text.error();
  const std::string rules = with_faults_known(*text);
  EXPECT_THAT(rules, testing::HasSubstr("TRIGGER camera_driver_issue || hardware_disconnect\n"));
  EXPECT_THAT(rules, testing::HasSubstr("TRIGGER sync_issue || memory_leakage\n"));
  EXPECT_THAT(rules, testing::HasSubstr("TRIGGER cuda_out_of_memory || gpu_failure\n"));
  EXPECT_EQ(rules.find("age("), rules.rfind("age("));  // of the depth camera
  EXPECT_TRUE(check(Source("known.rules", rules)).rules);
}

TEST(Detectors, PhiTakesThePlaceOfEachAge) {
  const auto text = read_text("rules/sunset.rules");
  ASSERT_TRUE(text) << text.error();
  const std::string rules = with_phi(*text);
  EXPECT_THAT(rules, testing::Not(testing::HasSubstr("age(")));
  EXPECT_THAT(rules, testing::Not(testing::HasSubstr("silence\n")));
  EXPECT_THAT(rules, testing::HasSubstr("phi(/managed_subsystem/segmentation) > suspicion\n"));
  EXPECT_THAT(rules, testing::HasSubstr("CONST suspicion     = 8\n"));
}

}  // namespace
}  // namespace culprit::study
