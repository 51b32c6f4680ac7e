#include "rca_study/campaign.h"

#include <gtest/gtest.h>

#include "plan/bayes/bayes_planner.h"
#include "plan/paper_planner.h"
#include "rca_study/rca_report.h"
#include "rca_study/rules.h"

namespace culprit::study::rca {
namespace {

RcaCampaign small_campaign() {
  RcaCampaign campaign;
  campaign.settings = {{12, 2, 0, true}};
  campaign.planners = planner_names();
  std::erase(campaign.planners, "optimum");
  campaign.episodes = 3;
  campaign.seed = 5;
  return campaign;
}

TEST(RcaCampaign, IsTheSameWithAnyNumberOfThreads) {
  const auto one = run_campaign(small_campaign(), 1, nullptr);
  const auto four = run_campaign(small_campaign(), 4, nullptr);
  ASSERT_TRUE(one && four);
  EXPECT_EQ(rca_json(small_campaign(), *one, Times::kLeftOut),
            rca_json(small_campaign(), *four, Times::kLeftOut));
}

TEST(RcaCampaign, TellsHowFarItIsAndStopsWhenItIsTold) {
  const RcaCampaign campaign = small_campaign();
  std::vector<std::uint64_t> told;
  const std::uint64_t all =
      3 * campaign.rows() + 3;  // episodes, and robots with an optimum or none
  ASSERT_TRUE(run_campaign(campaign, 2, [&](std::uint64_t done, std::uint64_t total) {
    told.push_back(done);
    return total == all;
  }));
  ASSERT_EQ(told.size(), all);
  EXPECT_EQ(told.front(), 1u);
  EXPECT_EQ(told.back(), all);
  EXPECT_FALSE(
      run_campaign(campaign, 2, [](std::uint64_t done, std::uint64_t) { return done < 5; }));
}

TEST(RcaCampaign, HasARowForEachPlannerAndSetting) {
  RcaCampaign campaign = small_campaign();
  campaign.settings.push_back({5, 1, 0.1, false});
  campaign.planners = {"naive", "bayes"};
  const auto rows = run_campaign(campaign, 2, nullptr);
  ASSERT_TRUE(rows);
  ASSERT_EQ(rows->size(), 4u);
  EXPECT_EQ(rows->at(2).planner, "naive");
  EXPECT_EQ(rows->at(2).setting.components, 5u);
  EXPECT_EQ(rows->at(3).episodes, 3);
}

TEST(RcaRules, NumberThingsAsTheScenarioDoes) {
  const RcaScenario scenario = generate({30, 1, 0.1, true}, 1);
  const RuleSet rules = rules_of(scenario);
  ASSERT_EQ(rules.components.size(), 30u);
  for (std::size_t i = 0; i < 30; ++i) {
    const std::string name = "c" + std::to_string(i);
    EXPECT_EQ(rules.components[i].name, name);
    EXPECT_EQ(rules.rules[i].name, name + "_fails");
    EXPECT_EQ(rules.signals[i].name, name + "_ill");
    EXPECT_EQ(rules.signals[i].type, Type::kBool);
    EXPECT_EQ(rules.rules[i].policies.hold_needed, 10);
    EXPECT_EQ(rules.rules[i].policies.hold_window, 15);
  }
}

TEST(RcaCampaign, IgnoresTheInfrastructureWhereTheRulesSaySo) {
  RcaSetting setting{20, 2, 0, false};
  EXPECT_TRUE(rules_of(generate(setting, 1)).ignored_topics.empty());
  setting.ignores_plumbing = true;
  EXPECT_EQ(rules_of(generate(setting, 1)).ignored_topics,
            (std::vector<std::string>{"/tf", "/diagnostics", "/robot_state"}));
  // With it, nearly every robot has circles of dependencies in which the paper's planner waits.
  RcaCampaign campaign;
  campaign.settings = {setting, {20, 2, 0, false}};
  campaign.planners = {"paper"};
  campaign.episodes = 10;
  const auto rows = run_campaign(campaign, 2, nullptr);
  ASSERT_TRUE(rows);
  EXPECT_LT(rows->at(0).unresolved.mean(), rows->at(1).unresolved.mean());
}

// Effects of the unfixable fault are not replaced: only that fault remains, and no other component
// is tried.
TEST(RcaCampaign, LeavesWhatNothingFixesToAPerson) {
  RcaCampaign campaign;
  RcaSetting setting{12, 2, 0, false};
  setting.has_unfixable = true;
  campaign.settings = {setting};
  campaign.planners = {"bayes", "naive"};
  campaign.episodes = 20;
  const auto rows = run_campaign(campaign, 2, nullptr);
  ASSERT_TRUE(rows);
  const RcaRow& bayes = rows->at(0);
  EXPECT_EQ(bayes.censored, bayes.episodes);
  EXPECT_GE(bayes.unresolved.mean(), 1);
  EXPECT_LT(bayes.wrong_component.mean(), rows->at(1).wrong_component.mean() / 4);
}

TEST(RcaCampaign, HasFaultsThatAllComeAndGo) {
  RcaSetting setting{12, 3, 0, false};
  setting.is_flapping = true;
  for (const InjectedFault& fault : generate(setting, 1).faults)
    EXPECT_EQ(fault.kind, FaultKind::kFlapping);
}

// A chain with a fault at its head: a planner that uses the graph repairs the head alone.
TEST(RcaEpisode, TellsTheCauseFromItsEffects) {
  RcaScenario scenario = generate({4, 1, 0, false}, 1);
  scenario.topics.clear();
  for (std::size_t i = 0; i < 3; ++i)
    scenario.topics.push_back({"/t" + std::to_string(i), {i}, {{i + 1, 1, 0.5, false}}});
  scenario.faults = {{0, FaultKind::kHang, 3}};
  for (RcaComponent& c : scenario.components) c.treatments[2].helps.fill(1);
  const EpisodeResult bayes = play(scenario, std::make_unique<BayesPlanner>());
  EXPECT_TRUE(bayes.is_recovered);
  EXPECT_TRUE(bayes.is_exact);
  EXPECT_EQ(bayes.wrong_component, 0);
  EXPECT_EQ(bayes.effects, 3);
  EXPECT_EQ(bayes.grounded, 3);
  const EpisodeResult naive =
      play(scenario, std::make_unique<PaperPlanner>(PaperSwitches{false, true, true}));
  EXPECT_FALSE(naive.is_exact);
  EXPECT_GT(naive.wrong_component, 0);
}

}  // namespace
}  // namespace culprit::study::rca
