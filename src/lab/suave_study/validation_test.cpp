#include "suave_study/validation.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "suave_study/fit.h"

namespace culprit::study {
namespace {

SuaveCampaign campaign() {
  SuaveCampaign campaign;
  campaign.plan = *suave::model::find_mission_plan("standard");
  campaign.generation = *suave::model::find_generation("era");
  campaign.runs = 60;
  campaign.seed = 5;
  return campaign;
}

// The model's results with another seed: recorded runs of known origin.
RecordedCampaign recorded(SuaveCampaign campaign, double later_s = 0) {
  campaign.managers = {"none", "bt", "rosa"};
  campaign.seed = 77;
  RecordedCampaign recorded;
  for (const SuaveRow& row : run_campaign(campaign, 2).rows) {
    recorded.rows.push_back({row.manager,
                             Moments::of_summary(row.search_s.mean() + later_s,
                                                 row.search_s.sample_sd(), row.search_s.count()),
                             row.distance_m});
  }
  return recorded;
}

TEST(SuaveValidation, FindsTheModelEquivalentToItself) {
  const Validation validation = validate(campaign(), recorded(campaign()), 0.75, 2);
  ASSERT_EQ(validation.rows.size(), 6u);
  for (const ValidationRow& row : validation.rows) {
    ASSERT_TRUE(row.test) << row.manager;
    EXPECT_TRUE(row.is_within) << row.manager << ' ' << row.metric;
    EXPECT_TRUE(row.test->is_equivalent())
        << row.manager << ' ' << row.metric << ' ' << row.test->p;
  }
  ASSERT_EQ(validation.ranks.size(), 2u);
  EXPECT_EQ(validation.ranks[0].managers, 3u);
  EXPECT_GE(*validation.ranks[0].spearman_rho, 0.5);
}

// 0.9 sd off: still "within 1 sd", which therefore says little.
TEST(SuaveValidation, DoesNotFindARobotEquivalentThatSearchesLonger) {
  const RecordedCampaign plain = recorded(campaign());
  const double sd = plain.rows[1].search_s.sample_sd();
  const Validation validation = validate(campaign(), recorded(campaign(), 0.9 * sd), 0.5, 2);
  const ValidationRow& bt = validation.rows[1];
  ASSERT_EQ(bt.manager, "bt");
  EXPECT_FALSE(bt.test->is_equivalent());
  EXPECT_THAT(validation_json(validation), testing::HasSubstr("\"equivalent\": false"));
  EXPECT_EQ(validation_tables(validation).size(), 2u);
}

// A vehicle that was made slower is found again from its runs: what is fitted on one campaign makes
// the other, which was not fitted, come out better.
TEST(SuaveFit, BringsAVehicleCloserToTheOneThatWasRecorded) {
  SuaveCampaign slow = campaign();
  slow.vehicle.cruise = 0.6;
  slow.managers = {"none", "bt"};
  slow.seed = 77;
  FitCampaign target{campaign(), {}};
  for (const SuaveRow& row : run_campaign(slow, 2).rows)
    target.targets.push_back({row.manager, row.search_s, row.distance_m});
  int steps = 0;
  const auto fit = fit_vehicle({target}, {}, 10, 2, [&](const std::string&) { ++steps; });
  ASSERT_TRUE(fit);
  EXPECT_GT(steps, 0);
  EXPECT_LT(fit->misfit, fit->misfit_before / 2);

  slow.seed = 78;
  const SuaveResult held_out = run_campaign(slow, 2);
  const auto error_with = [&](const suave::model::VehicleTraits& vehicle) {
    SuaveCampaign again = slow;
    again.vehicle = vehicle;
    again.seed = 79;
    const SuaveResult modelled = run_campaign(again, 2);
    double sum = 0;
    for (std::size_t i = 0; i < modelled.rows.size(); ++i)
      sum += std::abs(modelled.rows[i].distance_m.mean() - held_out.rows[i].distance_m.mean());
    return sum;
  };
  EXPECT_LT(error_with(fit->vehicle), error_with({}));
}

TEST(SuaveFit, HasNothingToDoForCulpritAlone) {
  FitCampaign target{
      campaign(), {{kCulprit, Moments::of_summary(80, 10, 100), Moments::of_summary(60, 5, 100)}}};
  EXPECT_FALSE(fit_vehicle({target}, {}, 10, 2, [](const std::string&) {}));
}

}  // namespace
}  // namespace culprit::study
