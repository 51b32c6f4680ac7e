#include "sunset_study/sweep.h"

#include <gtest/gtest.h>

#include "json/json.h"
#include "sunset_study/study.h"

namespace culprit::study {
namespace {

const Configuration kWhole{{true, true, true}, "paper", "paper", Probabilities::kIdeal};

TEST(Variations, ChangeTheProfileAndTheRules) {
  Variation variation;
  variation.relaunch = std::chrono::seconds(3);
  variation.window = 7;
  variation.patience = 2;
  const auto plain = SunsetStudy::make({kWhole}, 1);
  const auto changed = SunsetStudy::make({kWhole}, 1, variation);
  EXPECT_EQ(changed->profile(0).start.least, std::chrono::seconds(3));
  EXPECT_EQ(changed->profile(0).frequency_window, 7u);
  EXPECT_EQ(changed->profile(0).blackboard_period, plain->profile(0).blackboard_period);
  EXPECT_EQ(changed->rules(0).heaviest.count, 2 * plain->rules(0).heaviest.count);
  for (std::size_t i = 0; i < plain->rules(0).strategies.size(); ++i) {
    const Strategy& before = plain->rules(0).strategies[i];
    const Strategy& after = changed->rules(0).strategies[i];
    const bool is_restart = before.name.ends_with("restart") || before.name.ends_with("redeploy");
    EXPECT_EQ(after.impact.count, before.impact.count * (is_restart ? 2 : 1)) << before.name;
  }
}

TEST(Variations, TakeTheRulesOfAFile) {
  Variation variation;
  variation.rules =
      "COMPONENT camera NODE /managed_subsystem/camera LAUNCH \"sunset-node camera\"\n"
      "RULE RGBDead\n  POLICIES ERROR\n  TRIGGER age(/managed_subsystem/rgb_camera) > 350ms\n"
      "    STRATEGY rgb_redeploy 90 10\n      ADAPTATION camera redeploy 3\n";
  const auto study = SunsetStudy::make({kWhole}, 1, variation);
  ASSERT_TRUE(study) << study.error();
  EXPECT_EQ(study->rules(0).strategies.size(), 1u);
  variation.rules = "RULE";
  EXPECT_FALSE(SunsetStudy::make({kWhole}, 1, variation));
}

// A relaunch that takes longer is a downtime that takes longer.
TEST(Variations, OfTheRelaunchShowInTheDowntime) {
  Variation slow;
  slow.relaunch = std::chrono::seconds(4);
  double plain_s = 0;
  double slow_s = 0;
  for (std::uint32_t run = 0; run < 18; ++run) {
    plain_s += SunsetStudy::make({kWhole}, 1)->run({0, run}).honest.downtime_s;
    slow_s += SunsetStudy::make({kWhole}, 1, slow)->run({0, run}).honest.downtime_s;
  }
  EXPECT_GT(slow_s, plain_s + 9);
}

TEST(Sweep, StopsWhenItIsTold) {
  SweepCampaign campaign;
  campaign.planners = {"reference"};
  campaign.runs = 1;
  const auto points = sweep(campaign, 1, [](std::uint64_t done) { return done < 2; });
  ASSERT_TRUE(points) << points.error();
  ASSERT_EQ(points->size(), 2u);
  const auto tables = sweep_tables(*points, campaign);
  ASSERT_EQ(tables.size(), 2u);
  for (const Table& table : tables)
    for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size());
  const Json json = parse_strict_json(sweep_json(*points, campaign, "the command", "test"));
  EXPECT_EQ(json["campaign"]["command"], "the command");
  ASSERT_EQ(json["sweep"].size(), 2u);
  EXPECT_EQ(json["sweep"][0]["relaunch_s"], 0.5);
  EXPECT_TRUE(json["sweep"][0]["rho"].contains("downtime_s"));
  EXPECT_EQ(json["sweep"][0]["downtime_shortened"], 0) << "one run shows no significant effect";
  EXPECT_GT(sweep_size(campaign), 20u);
  campaign.planners = {"bt"};
  EXPECT_FALSE(sweep(campaign, 1, [](std::uint64_t) { return true; }));
}

}  // namespace
}  // namespace culprit::study
