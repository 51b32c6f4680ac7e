#include "knowledge/couplings.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

RuleSet two_rules() {
  std::string text;
  for (const char* name : {"A", "B"}) {
    text += std::string("RULE ") + name +
            "\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY s 50 10\nADAPTATION c restart 1\n";
  }
  return *check(Source("t", text)).rules;
}

constexpr RuleId kA{std::size_t{0}};
constexpr RuleId kB{std::size_t{1}};

TEST(Couplings, BeginWithWhatIsExpected) {
  const RuleSet rules = two_rules();
  const Couplings couplings(rules);
  EXPECT_DOUBLE_EQ(couplings.of(kA, kB).mean(Coupling::kUsual), 0.95);
  EXPECT_DOUBLE_EQ(couplings.of(kA, kB).mean(Coupling::kRare), 0.05);
}

TEST(Couplings, AreOfAnOrderedPair) {
  const RuleSet rules = two_rules();
  Couplings couplings(rules);
  couplings.stayed(kA, kB);
  EXPECT_DOUBLE_EQ(couplings.of(kA, kB).mean(0.95), (2 * 0.95) / 3);
  EXPECT_DOUBLE_EQ(couplings.of(kB, kA).mean(0.95), 0.95);
}

TEST(Couplings, ConvergeToTheTrueShare) {
  const RuleSet rules = two_rules();
  Couplings couplings(rules);
  for (int i = 0; i < 1000; ++i) i % 4 == 0 ? couplings.cleared(kA, kB) : couplings.stayed(kA, kB);
  EXPECT_NEAR(couplings.of(kA, kB).mean(0.95), 0.25, 0.01);
}

// It came and went for hours, and nothing followed. Later it is found to be the cause, once.
TEST(Couplings, NeverLearnMoreFromExposureThanOneOutcomeCanRefute) {
  const RuleSet rules = two_rules();
  Couplings couplings(rules);
  for (int i = 0; i < 1000; ++i) couplings.stayed_away(kA, kB, 10);
  EXPECT_DOUBLE_EQ(couplings.of(kA, kB).mean(Coupling::kUsual), 1.9 / 52);
  couplings.cleared(kA, kB);
  EXPECT_DOUBLE_EQ(couplings.of(kA, kB).mean(Coupling::kUsual), 2.9 / 53);
  couplings.set(kA, kB, {0, 0, 1e6});  // of an older culprit, or of many robots
  EXPECT_DOUBLE_EQ(couplings.of(kA, kB).mean(Coupling::kUsual), 1.9 / 52);
}

TEST(Couplings, FollowADriftWithForgetting) {
  const RuleSet rules = two_rules();
  Couplings couplings(rules);
  couplings.set_forgetting(0.9);
  for (int i = 0; i < 500; ++i) couplings.cleared(kA, kB);
  for (int i = 0; i < 50; ++i) couplings.stayed(kA, kB);
  EXPECT_LT(couplings.of(kA, kB).mean(0.95), 0.2);
}

}  // namespace
}  // namespace culprit
