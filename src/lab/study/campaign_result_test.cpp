#include "study/campaign_result.h"

#include <tuple>

#include <gtest/gtest.h>

#include "study/test_findings.h"

namespace culprit::study {
namespace {

Campaign one_row(std::uint32_t runs) {
  Campaign campaign;
  campaign.rows.resize(1);
  campaign.runs = runs;
  return campaign;
}

Row fold(const std::vector<RunMetrics>& runs) {
  CampaignFold fold(one_row(static_cast<std::uint32_t>(runs.size())));
  for (const RunMetrics& run : runs) fold.add(run);
  EXPECT_TRUE(fold.is_complete());
  return std::move(fold).result().rows.front();
}

TEST(CampaignFold, TakesRunsInTheOrderOfTheCampaign) {
  const Campaign campaign = synthetic_campaign(5);
  EXPECT_EQ(campaign.size(), 45u);
  EXPECT_EQ(campaign[0], (RunId{0, 0}));
  EXPECT_EQ(campaign[4], (RunId{0, 4}));
  EXPECT_EQ(campaign[5], (RunId{1, 0}));
  EXPECT_EQ(campaign[44], (RunId{8, 4}));
}

TEST(CampaignFold, PoolsReactionTimesOverTheRuns) {
  RunMetrics many{.reactions_s = {1, 2, 3}};
  const Row row = fold({many, {}, {.reactions_s = {6}}});
  EXPECT_EQ(row[Metric::kReaction].count(), 4);
  EXPECT_DOUBLE_EQ(row[Metric::kReaction].mean(), 3);
  EXPECT_EQ(row[Metric::kRatio].count(), 3);
  EXPECT_EQ(row[Metric::kReaction].independent().count(), 2) << "two runs have reaction times";
  EXPECT_EQ(row[Metric::kRatio].independent().count(), 3);
}

// As the script does: a run that it leaves out still counts its redeployments.
TEST(CampaignFold, CountsTheRedeploymentsOfRunsThatAreLeftOut) {
  RunMetrics out;
  out.is_left_out = true;
  out.ratio = 100;
  out.reactions_s = {100};
  out.downtime_s = 100;
  out.unnecessary_redeployments = 3;
  out.honest.downtime_s = 7;
  const Row row = fold({out, {.unnecessary_redeployments = -1}});
  EXPECT_EQ(row.runs, 2);
  EXPECT_EQ(row[Metric::kRatio].count(), 1);
  EXPECT_EQ(row[Metric::kReaction].count(), 0);
  EXPECT_EQ(row[Metric::kDowntime].mean(), 0);
  EXPECT_EQ(row[Metric::kUnnecessaryRedeployments].mean(), 1);
  EXPECT_EQ(row[Metric::kHonestDowntime].mean(), 3.5) << "honesty leaves nothing out";
}

TEST(CampaignFold, CensorsWhatDidNotRecoverInsteadOfDroppingIt) {
  RunMetrics recovered;
  recovered.honest.recovery_s = 4;
  RunMetrics never;
  never.honest.recovery_s = 20;
  never.honest.is_recovery_censored = true;
  const Row row = fold({recovered, never});
  const Summary& recovery = row[Metric::kRecovery];
  EXPECT_EQ(recovery.count(), 2);
  EXPECT_EQ(recovery.censored(), 1);
  EXPECT_DOUBLE_EQ(recovery.mean(), 12);
  EXPECT_EQ(recovery.distribution().count(), 1) << "a lower bound is no value";
}

TEST(CampaignFold, HasNoShareOfNothing) {
  const Row row = fold({{}, {}});
  EXPECT_EQ(row[Metric::kStrategiesPerFault].count(), 0);
  EXPECT_EQ(row[Metric::kTopCauseRight].count(), 0);
}

TEST(CampaignFold, FindsRowsByTheirConfiguration) {
  const CampaignResult result = synthetic_result(3);
  EXPECT_EQ(result.find(result.campaign.rows[8]), &result.rows[8]);
  EXPECT_EQ(result.find({{true, true, true}, "bayes", "paper", Probabilities::kIdeal}), nullptr);
}

// Each with so much downtime and so many wrong components.
CampaignResult measured(const std::vector<std::tuple<Configuration, double, int>>& rows) {
  Campaign campaign;
  for (const auto& row : rows) campaign.rows.push_back(std::get<Configuration>(row));
  campaign.runs = 1;
  CampaignFold fold(campaign);
  for (const auto& row : rows) {
    RunMetrics run;
    run.honest.downtime_s = std::get<double>(row);
    run.honest.wrong_component = std::get<int>(row);
    fold.add(run);
  }
  return std::move(fold).result();
}

TEST(OnFront, ComparesPlannersThatPlayTheSame) {
  const CampaignResult result = measured({{{{}, "paper", "paper"}, 6, 1},
                                          {{{}, "bayes", "paper"}, 6, 0},
                                          {{{}, "bayes:downtime", "paper"}, 5, 2},
                                          {{{}, "oracle", "paper"}, 0, 0},
                                          {{{}, "paper", "paper:age"}, 1, 1}});
  const auto front = on_front(result);
  EXPECT_EQ(front[0], false) << "bayes is as good in the one and better in the other";
  EXPECT_EQ(front[1], true);
  EXPECT_EQ(front[2], true);
  EXPECT_EQ(front[3], std::nullopt) << "nobody can be an oracle";
  EXPECT_EQ(front[4], true) << "it sees more";
}

}  // namespace
}  // namespace culprit::study
