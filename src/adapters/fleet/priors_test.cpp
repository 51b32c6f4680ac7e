#include "fleet/priors.h"

#include <gtest/gtest.h>

#include "fleet/test_journal.h"
#include "language/checker.h"

namespace culprit::fleet {
namespace {

const StrategyName kRestart{"Silent", "restart"};

RuleSet fleet_rules() { return *check(Source("rules", kFleetRules)).rules; }

RobotOutcomes robots(int count, double helped, double failed) {
  RobotOutcomes sums;
  for (int i = 0; i < count; ++i) sums.add(helped, failed);
  return sums;
}

// To the last bit: differences are reported.
void expect_those_of(const RuleSet& rules, const PriorsTold& told) {
  ASSERT_EQ(told.priors.size(), rules.strategies.size());
  for (const PriorsTold::Prior& each : told.priors) {
    const Strategy& strategy = rules[each.strategy];
    EXPECT_EQ((Belief{each.alpha, each.beta}),
              initial_belief(strategy.success, strategy.confidence));
  }
  EXPECT_EQ(told.source, "");
}

TEST(FleetPriors, AreTheRulesWhereNobodyHasOutcomes) {
  const RuleSet rules = fleet_rules();
  expect_those_of(rules, priors_for(rules, {"rover", {}}));
}

TEST(FleetPriors, SayWhoseOutcomesTheyAre) {
  const RuleSet rules = fleet_rules();
  FleetKnowledge knowledge{"rover", {}};
  knowledge.strategies[kRestart].models["rover"] = robots(12, 1, 9);
  knowledge.strategies[kRestart].models["other"] = robots(3, 9, 1);
  const PriorsTold told = priors_for(rules, knowledge);
  EXPECT_EQ(told.source, "12 robots of rover and 3 of other models");
  ASSERT_EQ(told.priors.size(), 2u);
  EXPECT_LT(told.priors[0].alpha / (told.priors[0].alpha + told.priors[0].beta), 0.3);
  EXPECT_EQ(told.priors[1].alpha, 5) << "nobody tried it";
}

// It knows its own outcomes without the fleet.
TEST(FleetPriors, LeaveOutTheRobotsOwnOutcomes) {
  const RuleSet rules = fleet_rules();
  FleetKnowledge knowledge{"rover", {}};
  StrategyKnowledge& known = knowledge.strategies[kRestart];
  known.models["rover"] = robots(1, 30, 0);
  known.recent_helped = 30;
  expect_those_of(rules, priors_for(rules, knowledge));
}

TEST(FleetPriors, TellOnlyWhatIsNew) {
  const RuleSet rules = fleet_rules();
  FleetKnowledge knowledge{"rover", {}};
  knowledge.strategies[kRestart].models["rover"] = robots(12, 1, 9);
  const PriorsTold known = priors_for(rules, knowledge);
  EXPECT_TRUE(changes(known, known).priors.empty());
  knowledge.strategies[kRestart].models["rover"] = robots(12, 9, 1);
  const PriorsTold changed = changes(known, priors_for(rules, knowledge));
  ASSERT_EQ(changed.priors.size(), 1u);
  EXPECT_EQ(changed.priors[0].strategy, StrategyId(0));
  EXPECT_EQ(changes({}, known).priors.size(), 2u);
}

TEST(FleetPriors, ARobotThatDiffersIsFound) {
  const RuleSet rules = fleet_rules();
  FleetKnowledge knowledge{"rover", {}};
  StrategyKnowledge& known = knowledge.strategies[kRestart];
  known.models["rover"] = robots(20, 9, 1);
  known.models["rover"].add(1, 11);
  known.recent_helped = 1;
  known.recent_failed = 11;
  known.own = {1, 11};
  const auto found = deviations(rules, knowledge);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(describe(found[0]).find("restart for Silent helped 1 of 12 times here"),
            std::string::npos)
      << describe(found[0]);
  known.own = {10, 2};
  EXPECT_TRUE(deviations(rules, knowledge).empty());
}

TEST(FleetPriors, ComeBackFromText) {
  FleetKnowledge knowledge{"rover", {}};
  StrategyKnowledge& known = knowledge.strategies[kRestart];
  known.models["rover"] = robots(7, 3, 4);
  known.own = {2, 1};
  known.recent_helped = 1.5;
  const FleetKnowledge back = knowledge_from_text(to_text(knowledge));
  EXPECT_EQ(back.model, "rover");
  EXPECT_EQ(back.strategies.at(kRestart).own, known.own);
  EXPECT_EQ(back.strategies.at(kRestart).recent_helped, 1.5);
  EXPECT_EQ(back.strategies.at(kRestart).models.at("rover").spread, known.models["rover"].spread);
}

TEST(FleetPriors, OfDamagedTextAreNone) {
  for (
      const char* text :
      {"", "7", "[]", R"({"strategies":7})", R"({"strategies":[7]})",
       R"({"strategies":[{"rule":"R","strategy":"s","models":[],"recent":[1,2],"own":[1,1]}]})",
       R"({"strategies":[{"rule":"R","strategy":"s","models":{},"recent":[1],"own":[1,1]}]})",
       R"({"strategies":[{"rule":"R","strategy":"s","models":{},"recent":[1,1],"own":[1e99,1]}]})"})
    EXPECT_TRUE(knowledge_from_text(text).strategies.empty()) << text;
}

}  // namespace
}  // namespace culprit::fleet
