#include "study/rca/regret.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "plan/bayes/bayes_planner.h"
#include "study/rca/optimum.h"
#include "study/rca/rules.h"

namespace culprit::study::rca {
namespace {

TEST(Regret, IsOfSmallRobotsOfEveryKind) {
  const RegretCampaign campaign;
  std::array<std::array<bool, 2>, 2> seen{};
  for (std::uint32_t i = 0; i < 100; ++i) {
    const RcaSetting setting = regret_setting(campaign, i);
    seen[setting.is_cyclic][setting.has_mixed_levels] = true;
    const RcaScenario scenario = regret_scenario(campaign, i);
    EXPECT_TRUE(RepairProcess::is_small(scenario)) << i;
    EXPECT_TRUE(setting.is_cyclic || !setting_of(scenario).is_cyclic) << i;
  }
  for (const auto& each : seen) EXPECT_TRUE(each[0] && each[1]);
}

TEST(Regret, IsToldByMeanPercentileAndWorst) {
  Regrets regrets;
  for (int i = 0; i < 100; ++i) regrets.of.push_back(i == 7 ? 0.5 : i < 96 ? 0.0 : 0.1);
  EXPECT_NEAR(regrets.mean(), 0.009, 1e-12);
  EXPECT_EQ(regrets.percentile_95(), 0);
  EXPECT_EQ(regrets.worst(), 7u);
}

// Of robots of up to three components, which take seconds; the rest is in docs/study-rca.md. Also
// those that were the worst: circles with two faults.
TEST(Regret, IsSmallOnRobotsThatAreAsTold) {
  RegretCampaign campaign;
  campaign.systems = 60;
  std::array<Regrets, 4> all{Regrets{Objective::kBalanced, {}}, Regrets{Objective::kDowntime, {}},
                             Regrets{Objective::kAdaptations, {}},
                             Regrets{Objective::kRedeployments, {}}};
  for (std::uint32_t i = 0; i < campaign.systems; ++i) {
    if (regret_setting(campaign, i).components > 3) continue;
    const RcaScenario scenario = regret_scenario(campaign, i);
    const RuleSet rules = rules_of(scenario);
    for (Regrets& each : all) {
      const RepairProcess process(scenario, rules, each.objective);
      const double ours = expected_cost(process, rules, BayesPlanner(each.objective));
      each.of.push_back(ours / Optimum(process).cost() - 1);
    }
  }
  for (const Regrets& each : all) {
    const auto name = to_string(each.objective);
    EXPECT_LE(each.mean(), 0.01) << name;
    EXPECT_LE(each.percentile_95(), 0.05) << name;
    EXPECT_LE(each.of[each.worst()], 0.15) << name << ", of those taken number " << each.worst();
  }
}

TEST(Regret, IsTheSameWithAnyNumberOfThreads) {
  RegretCampaign campaign;
  campaign.systems = 3;
  const auto one = measure_regret(campaign, 1, nullptr);
  const auto two = measure_regret(campaign, 2, nullptr);
  ASSERT_TRUE(one && two);
  EXPECT_EQ(regret_json(campaign, *one), regret_json(campaign, *two));
  const auto json = nlohmann::json::parse(regret_json(campaign, *one));
  EXPECT_EQ(json["regret"]["objectives"].size(), 4u);
  EXPECT_FALSE(measure_regret(campaign, 1, [](std::uint64_t, std::uint64_t) { return false; }));
}

// A robot of one component has no feedback, whatever is asked for.
TEST(Generator, MakesACircleOnlyOfTwoOrMore) {
  const RcaScenario scenario = generate({1, 1, 0, true}, 1);
  EXPECT_EQ(scenario.components.size(), 1u);
  EXPECT_FALSE(setting_of(scenario).is_cyclic);
}

TEST(Generator, MixesLevelsIfItIsAskedTo) {
  RcaSetting setting{30, 1, 0, false};
  setting.has_mixed_levels = true;
  std::array<int, 3> of_level{};
  for (const RcaComponent& c : generate(setting, 1).components)
    ++of_level[static_cast<std::size_t>(c.criticality)];
  for (const int count : of_level) EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace culprit::study::rca
