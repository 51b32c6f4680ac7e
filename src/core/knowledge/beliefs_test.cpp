#include "knowledge/beliefs.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

TEST(Beliefs, BeginWhereTheDesignerPutThem) {
  const Belief belief = initial_belief(percent(80), 50);
  EXPECT_DOUBLE_EQ(belief.alpha, 40);
  EXPECT_DOUBLE_EQ(belief.beta, 10);
  EXPECT_DOUBLE_EQ(belief.mean().value, 0.8);
}

// A low confidence is a weak belief, not another one.
TEST(Beliefs, BeginWhereTheDesignerPutThemHoweverLittleThatWeighs) {
  EXPECT_DOUBLE_EQ(initial_belief(percent(90), 1).mean().value, 0.9);
  EXPECT_DOUBLE_EQ(initial_belief(percent(10), 1).mean().value, 0.1);
  EXPECT_DOUBLE_EQ(initial_belief(percent(99), 0.5).mean().value, 0.99);
}

TEST(Beliefs, CountOneOutcomeAsOneHoweverWeakTheyAre) {
  const Checked checked = check(Source(
      "t", "RULE R\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY s 99 1\nADAPTATION c restart 1\n"));
  Beliefs beliefs(*checked.rules);
  beliefs.helped(StrategyId(0));
  EXPECT_DOUBLE_EQ(beliefs[StrategyId(0)].alpha, 1.99);
  EXPECT_NEAR(beliefs[StrategyId(0)].beta, 0.01, 1e-12);
}

TEST(Beliefs, CanUnlearnCertainty) {
  const Belief certain = initial_belief(percent(100), 10);
  EXPECT_LT(certain.mean().value, 1);
  EXPECT_GT(certain.beta, 0);
}

// The paper's update is the posterior mean of a Bernoulli rate: after many outcomes the designer's
// belief hardly counts.
TEST(Beliefs, ConvergeToTheTrueRate) {
  const Checked checked = check(Source(
      "t", "RULE R\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY s 90 10\nADAPTATION c restart 1\n"));
  Beliefs beliefs(*checked.rules);
  for (int i = 0; i < 1000; ++i)
    i % 4 == 0 ? beliefs.helped(StrategyId(0)) : beliefs.did_not_help(StrategyId(0));
  EXPECT_NEAR(beliefs[StrategyId(0)].mean().value, 0.25, 0.01);
}

TEST(Beliefs, FollowADriftWithForgetting) {
  const Checked checked = check(Source(
      "t", "RULE R\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY s 90 10\nADAPTATION c restart 1\n"));
  Beliefs beliefs(*checked.rules);
  beliefs.set_forgetting(0.9);
  for (int i = 0; i < 500; ++i) beliefs.helped(StrategyId(0));
  for (int i = 0; i < 50; ++i) beliefs.did_not_help(StrategyId(0));
  EXPECT_LT(beliefs[StrategyId(0)].mean().value, 0.02);
  EXPECT_GT(beliefs[StrategyId(0)].mean().value, 0);
}

const RuleSet& one_strategy() {
  static const Checked checked = check(Source(
      "t", "RULE R\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY s 90 10\nADAPTATION c restart 1\n"));
  return *checked.rules;
}

TEST(Beliefs, KeepWhatWasCountedWhenTheyBeginFromAnotherPrior) {
  const StrategyId s(0);
  Beliefs beliefs(one_strategy());
  beliefs.did_not_help(s);
  EXPECT_TRUE(beliefs.begin_from(s, {2, 4}));
  EXPECT_EQ(beliefs[s], (Belief{2, 5}));
  EXPECT_EQ(beliefs.prior(s), (Belief{2, 4}));
  EXPECT_FALSE(beliefs.begin_from(s, {2, 4}));
  beliefs.helped(s);
  beliefs.begin_from(s, {6, 6});
  EXPECT_EQ(beliefs[s], (Belief{7, 7}));
  beliefs.forget(s);
  EXPECT_EQ(beliefs[s], (Belief{6, 6}));
}

// The share of the old prior that is left is unknown.
TEST(Beliefs, ThatForgetKeepWhatOutcomesMadeOfThem) {
  const StrategyId s(0);
  Beliefs beliefs(one_strategy());
  beliefs.set_forgetting(0.9);
  beliefs.begin_from(s, {2, 4});
  EXPECT_EQ(beliefs[s], (Belief{2, 4})) << "there were none yet";
  beliefs.helped(s);
  const Belief learned = beliefs[s];
  EXPECT_FALSE(beliefs.begin_from(s, {9, 1}));
  EXPECT_EQ(beliefs[s], learned);
  EXPECT_EQ(beliefs.prior(s), (Belief{2, 4}));
}

}  // namespace
}  // namespace culprit
