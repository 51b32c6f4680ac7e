#include "knowledge/transients.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;

constexpr RuleId kNoisy{std::size_t{0}};
constexpr RuleId kOtherRule{std::size_t{1}};
constexpr RuleId kThirdRule{std::size_t{2}};

struct TransientFailures : testing::Test {
  // It is there for `lasted`, and was not back for long.
  void clears(RuleId rule, Duration lasted) {
    transients.cleared(rule, now, now + lasted);
    transients.advance(now += 2 * lasted);
  }

  const RuleSet rules = *check(Source("x.rules",
                                      "COMPONENT c NODE /c LAUNCH \"c\"\n"
                                      "RULE Noisy\nPOLICIES ERROR\nTRIGGER x > 1\n"
                                      "STRATEGY again 90 10\nADAPTATION c restart 5\n"
                                      "RULE Other\nPOLICIES ERROR\nTRIGGER y > 1\n"
                                      "STRATEGY again 90 10\nADAPTATION c restart 5\n"
                                      "RULE Third\nPOLICIES ERROR\nTRIGGER z > 1\n"
                                      "STRATEGY again 90 10\nADAPTATION c restart 5\n"))
                             .rules;
  Transients transients{rules};
  Time now{100s};
};

TEST_F(TransientFailures, AreNotWaitedForWhileNoneWasSeen) {
  transients.stayed(kNoisy);
  EXPECT_EQ(transients.patience(kNoisy), 0s);
  EXPECT_EQ(transients.share(kNoisy), 0);
}

TEST_F(TransientFailures, AreWaitedForAsLongAsTheyTookAndTheFewerTheLonger) {
  clears(kNoisy, 2s);
  EXPECT_EQ(transients.patience(kNoisy), 6s);
  clears(kNoisy, 3s);
  EXPECT_EQ(transients.patience(kNoisy), 6s);
  for (int i = 0; i < 18; ++i) clears(kNoisy, 1s);
  EXPECT_EQ(transients.patience(kNoisy), 3300ms);
  EXPECT_GT(transients.share(kNoisy), 0.9);
}

TEST_F(TransientFailures, OfOtherRulesCountOnceTheyAreThreeOfTwoRules) {
  for (int i = 0; i < 9; ++i) clears(kNoisy, 2s);
  EXPECT_EQ(transients.patience(kOtherRule), 0s) << "one noisy monitor says nothing of another one";
  EXPECT_EQ(transients.share(kOtherRule), 0);
  clears(kOtherRule, 2s);
  EXPECT_EQ(transients.patience(kOtherRule), 2400ms) << "monitors of one robot resemble each other";
  EXPECT_GT(transients.share(kThirdRule), 0);
  EXPECT_EQ(transients.patience(kThirdRule), 2400ms);
}

TEST_F(TransientFailures, AreNeverWaitedForLongerThanTenSeconds) {
  clears(kNoisy, 8s);
  EXPECT_EQ(transients.patience(kNoisy), 10s);
  clears(kOtherRule, 11s);
  EXPECT_EQ(transients.seen(kOtherRule).cleared, 0);
}

TEST_F(TransientFailures, AreNoneIfTheyAreBackSoonerThanTheyLasted) {
  transients.cleared(kNoisy, now, now + 3s);
  transients.advance(now += 4500ms);
  transients.came_back(kNoisy);
  transients.advance(now += 1h);
  EXPECT_EQ(transients.seen(kNoisy), (Transients::Seen{0, 1, {}}));
}

TEST_F(TransientFailures, BecomeRareWithEachThatStays) {
  clears(kNoisy, 2s);
  clears(kThirdRule, 2s);
  clears(kThirdRule, 2s);
  const double before = transients.share(kNoisy);
  for (int i = 0; i < 20; ++i) transients.stayed(kOtherRule);
  EXPECT_LT(transients.share(kNoisy), before);
  EXPECT_LT(transients.share(kOtherRule), 0.1);
}

TEST_F(TransientFailures, AreForgottenWithTheirRule) {
  clears(kNoisy, 2s);
  transients.cleared(kNoisy, now, now + 2s);
  transients.forget(kNoisy);
  transients.advance(now + 1h);
  EXPECT_EQ(transients.seen(kNoisy), Transients::Seen());
  EXPECT_EQ(transients.patience(kOtherRule), 0s);
}

}  // namespace
}  // namespace culprit
