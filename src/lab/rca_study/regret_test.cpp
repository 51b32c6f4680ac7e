#include "rca_study/regret.h"

#include <atomic>

#include <gtest/gtest.h>

#include "json/json.h"
#include "plan/bayes/bayes_planner.h"
#include "rca_study/optimum.h"
#include "rca_study/rules.h"

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

void expect_within_bounds(const Regrets& regrets) {
  const auto name = to_string(regrets.objective);
  EXPECT_LE(regrets.mean(), 0.01) << name;
  EXPECT_LE(regrets.percentile_95(), 0.05) << name;
  EXPECT_LE(regrets.of[regrets.worst()], 0.15) << name << ", robot " << regrets.worst();
}

// The first of the thousand of docs/study-rca.md, which take seconds.
TEST(Regret, IsSmallOnRobotsThatAreAsTold) {
  RegretCampaign campaign;
  campaign.systems = 50;
  const auto all = measure_regret(campaign, 2, nullptr, nullptr);
  ASSERT_TRUE(all);
  for (const Regrets& each : *all) expect_within_bounds(each);
}

// The worst of the thousand, by objective.
TEST(Regret, IsBoundedOnTheWorstRobots) {
  const std::pair<Objective, std::uint32_t> worst[] = {{Objective::kBalanced, 230},
                                                       {Objective::kDowntime, 160},
                                                       {Objective::kAdaptations, 10},
                                                       {Objective::kRedeployments, 28}};
  for (const auto& [objective, system] : worst) {
    const RcaScenario scenario = regret_scenario({}, system);
    const RuleSet rules = rules_of(scenario);
    const RepairProcess process(scenario, rules, objective);
    const double ours = expected_cost(process, rules, BayesPlanner(objective));
    EXPECT_LE(ours, 1.15 * Optimum(process).cost()) << to_string(objective) << ", " << system;
  }
}

TEST(Regret, IsTheSameWithAnyNumberOfThreads) {
  RegretCampaign campaign;
  campaign.systems = 3;
  const auto one = measure_regret(campaign, 1, nullptr, nullptr);
  const auto two = measure_regret(campaign, 2, nullptr, nullptr);
  ASSERT_TRUE(one && two);
  EXPECT_EQ(regret_json(campaign, *one), regret_json(campaign, *two));
  const auto json = parse_json(regret_json(campaign, *one));
  EXPECT_EQ(json["regret"]["objectives"].size(), 4u);
  const auto never_on = [](std::uint64_t, std::uint64_t) { return false; };
  EXPECT_FALSE(measure_regret(campaign, 1, never_on, nullptr));
}

// All of a million systems would take days.
TEST(Regret, IsLeftUnfinishedAsSoonAsItIsStopped) {
  RegretCampaign campaign;
  campaign.systems = 1'000'000;
  std::atomic<int> asked = 0;
  EXPECT_FALSE(measure_regret(campaign, 2, nullptr, [&] { return ++asked > 5; }));
  EXPECT_LT(asked, 100);
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
