#include "study/comparison.h"

#include <gtest/gtest.h>

#include "study/test_findings.h"

namespace culprit::study {
namespace {

const CampaignResult& synthetic() {
  static const CampaignResult kResult = synthetic_result(400);
  return kResult;
}

TEST(Comparison, OfDataDrawnAroundThePapersMeansLiesWithin) {
  const auto found = ablations(synthetic());
  ASSERT_EQ(found.size(), 1u);
  const Agreement count = agreement(found.front());
  EXPECT_EQ(count.means, 32);
  EXPECT_EQ(count.means_within, 32);
  EXPECT_EQ(count.effects, 48);
  EXPECT_EQ(count.significant, 17);
  EXPECT_GE(count.significant_signs, 16);
}

TEST(Comparison, SaysWhatLiesOutside) {
  Campaign campaign;
  campaign.rows = {{{true, true, true}, "paper", "paper", Probabilities::kIdeal}};
  campaign.runs = 1;
  CampaignFold fold(campaign);
  RunMetrics run;
  run.ratio = 1.33;  // 1.01 +- 0.33
  run.downtime_s = 6.99;
  run.unnecessary_redeployments = 1;
  fold.add(run);
  const auto means = compare_means(fold.result().rows.front());
  ASSERT_EQ(means.size(), 4u);
  EXPECT_TRUE(means[0].is_within);
  EXPECT_FALSE(means[1].is_within) << "no reaction time, no agreement";
  EXPECT_FALSE(means[2].is_within);
  EXPECT_FALSE(means[3].is_within);
  EXPECT_TRUE(ablations(fold.result()).empty()) << "seven configurations are missing";
}

TEST(Comparison, JudgesEffectsByTukeysTestAndByWhatIsBetter) {
  const Ablation ablation = ablations(synthetic()).front();
  const Effect& criticality_with_d = ablation.effects[5];  // D - -  ->  D C -
  EXPECT_EQ(criticality_with_d.changes[0].significance, published::Significance::kBetter);
  EXPECT_NEAR(*criticality_with_d.changes[0].percent, 66, 8);
  EXPECT_LT(criticality_with_d.changes[0].difference.p, 1e-10);
  EXPECT_EQ(criticality_with_d.changes[1].significance, published::Significance::kWorse)
      << "a longer reaction time";
  const Change& noise = ablation.effects[4].changes[0];  // - - -  ->  - C -
  EXPECT_EQ(noise.significance, published::Significance::kNotSignificant);
  EXPECT_GT(noise.difference.p, 0.05);
}

TEST(Comparison, HasNoPercentOfZero) {
  Campaign campaign = synthetic_campaign(2);
  CampaignFold fold(campaign);
  while (!fold.is_complete()) {
    RunMetrics run;
    run.downtime_s = campaign[fold.size()].row;
    fold.add(run);
  }
  const Ablation ablation = ablations(fold.result()).front();
  const Change& change = ablation.effects.front().changes[2];
  EXPECT_FALSE(change.percent);
  EXPECT_EQ(change.difference.estimate, 4);
  EXPECT_FALSE(ablation.anovas[1]) << "no reaction time at all";
}

TEST(Comparison, KeepsPlannersApart) {
  Campaign campaign = synthetic_campaign(2);
  for (std::size_t i = 0; i < 8; ++i) {
    campaign.rows.push_back(campaign.rows[i]);
    campaign.rows.back().planner = "reference";
  }
  CampaignFold fold(campaign);
  while (!fold.is_complete()) {
    const RunId id = campaign[fold.size()];
    fold.add(synthetic_run(campaign.rows[id.row], id));
  }
  const auto found = ablations(fold.result());
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].planner, "paper");
  EXPECT_EQ(found[1].planner, "reference");
}

}  // namespace
}  // namespace culprit::study
