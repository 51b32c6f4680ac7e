#include "knowledge/latencies.h"

#include <gtest/gtest.h>

#include "language/checker.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;
using Range = Latencies::Range;

// Late and Other read a status each, and Told, which only reports, that of Late; Common and Beside one that both of
// them read; OnTopic none.
RuleSet latency_rules() {
  return *check(Source("x.rules", R"(
CYCLE 200ms
COMPONENT c NODE /c LAUNCH "c"
SIGNAL late   DIAGNOSTIC late   KEY x
SIGNAL other  DIAGNOSTIC other  KEY x
SIGNAL common DIAGNOSTIC common KEY x
SIGNAL beside DIAGNOSTIC common KEY y
RULE Late
  POLICIES ERROR
  TRIGGER late > 1
    STRATEGY slow 90 10
      ADAPTATION c redeploy 10
    STRATEGY fast 50 10
      ADAPTATION c restart 5
RULE Other
  POLICIES ERROR
  TRIGGER other > 1
    STRATEGY again 90 10
      ADAPTATION c restart 3
RULE Common
  POLICIES ERROR
  TRIGGER common > 1
    STRATEGY again 90 10
      ADAPTATION c restart 5
RULE Beside
  POLICIES ERROR
  TRIGGER beside > 1
    STRATEGY again 90 10
      ADAPTATION c restart 5
RULE OnTopic
  POLICIES ERROR
  TRIGGER age(/rgb) > 1s
    STRATEGY again 90 10
      ADAPTATION c restart 5
RULE Told
  POLICIES WARNING REPORT
  TRIGGER late > 2
)"))
              .rules;
}

constexpr RuleId kLate{std::size_t{0}};
constexpr RuleId kOther{std::size_t{1}};
constexpr RuleId kCommon{std::size_t{2}};
constexpr RuleId kOnTopic{std::size_t{4}};

struct LatenciesOfRules : testing::Test {
  const RuleSet rules = latency_rules();
  Latencies latencies{rules};
};

TEST_F(LatenciesOfRules, AreTheLeastImpactOfAStrategyBeforeAnythingIsLearned) {
  EXPECT_EQ(latencies.lateness(kLate), (Range{0s, 1s, 800ms}));
  EXPECT_EQ(latencies.lateness(kOther), (Range{0s, 600ms, 400ms}));
  EXPECT_EQ(latencies.learned(kLate).count, 0);
}

TEST_F(LatenciesOfRules, AreTheShortestAndTheLongestTimeThatWasLearned) {
  latencies.cleared(kLate, 2s);
  EXPECT_EQ(latencies.lateness(kLate), (Range{1800ms, 2s, 1800ms})) << "a reading takes a cycle";
  latencies.cleared(kLate, 3s);
  latencies.cleared(kLate, 1s);
  EXPECT_EQ(latencies.lateness(kLate), (Range{800ms, 3s, 800ms}));
  EXPECT_EQ(latencies.learned(kLate), (Latencies::Learned{3, {1s, 3s, 1s}}));
}

TEST_F(LatenciesOfRules, GrowWithHowLongAfterItsEffectsACauseFires) {
  latencies.fired(kLate, 2s);
  EXPECT_EQ(latencies.lateness(kLate).most, 1s) << "nothing is learned of it yet";
  latencies.cleared(kLate, 1500ms);
  latencies.fired(kLate, 1200ms);
  EXPECT_EQ(latencies.lateness(kLate).most, 1500ms);
  latencies.fired(kLate, 2s);
  EXPECT_EQ(latencies.lateness(kLate).most, 2s);
  latencies.fired(kLate, 60s);
  EXPECT_EQ(latencies.lateness(kLate).most, Latencies::kMostPatience);
}

TEST_F(LatenciesOfRules, AreNeverNegative) {
  latencies.cleared(kLate, -1s);
  EXPECT_EQ(latencies.lateness(kLate), (Range{0s, 1s, 0s})) << "it may fire as late as stated";
  EXPECT_EQ(latencies.learned(kLate).count, 1);
}

TEST_F(LatenciesOfRules, ExceedWhatIsStatedByAsMuchAsThoseThatWereLearned) {
  latencies.cleared(kLate, 3s);  // stated: 1 s, and a cycle for the reading
  EXPECT_EQ(latencies.lateness(kOther), (Range{0s, 2400ms, 400ms}));
  latencies.cleared(kOther, 500ms);
  EXPECT_EQ(latencies.lateness(kOther), (Range{300ms, 600ms, 300ms}))
      << "it clears soon, and may fire as late as stated";
}

TEST_F(LatenciesOfRules, DoNotExceedWhatIsStatedIfThoseThatWereLearnedDoNot) {
  latencies.cleared(kLate, 1200ms);
  EXPECT_EQ(latencies.lateness(kOther), (Range{0s, 600ms, 400ms}));
}

TEST_F(LatenciesOfRules, OfACommonMonitorAreZeroAndNothingIsLearnedOfThem) {
  EXPECT_EQ(latencies.lateness(kCommon), Range());
  latencies.cleared(kLate, 3s);
  EXPECT_EQ(latencies.lateness(kCommon), Range()) << "the excess is of rules that state a lateness";
  latencies.cleared(kCommon, 2s);
  EXPECT_EQ(latencies.lateness(kCommon), Range());
}

TEST_F(LatenciesOfRules, OnTopicsAreIgnored) {
  latencies.cleared(kOnTopic, 3s);
  latencies.set(kOnTopic, {2, {1s, 3s, 1s}});
  EXPECT_EQ(latencies.lateness(kOnTopic), Range());
  EXPECT_EQ(latencies.learned(kOnTopic).count, 0);
  EXPECT_EQ(latencies.lateness(kOther), (Range{0s, 600ms, 400ms}));
}

TEST_F(LatenciesOfRules, GoOnFromThoseOfAnEarlierRun) {
  latencies.set(kLate, {2, {1s, 3s, 1s}});
  EXPECT_EQ(latencies.lateness(kLate), (Range{800ms, 3s, 800ms}));
  EXPECT_EQ(latencies.lateness(kOther).most, 2400ms);
  latencies.cleared(kLate, 4s);
  EXPECT_EQ(latencies.learned(kLate), (Latencies::Learned{3, {1s, 4s, 1s}}));
}

TEST_F(LatenciesOfRules, ThatAreForgottenAreAsStatedAndExceedNothing) {
  latencies.cleared(kLate, 3s);
  latencies.cleared(kOther, 1s);
  latencies.forget(kLate);
  EXPECT_EQ(latencies.lateness(kLate), (Range{0s, 1200ms, 800ms}))
      << "the excess of the other is left";
  latencies.forget(kOther);
  EXPECT_EQ(latencies.lateness(kLate), (Range{0s, 1s, 800ms}));
}

TEST_F(LatenciesOfRules, CountNoFurtherThanTheyCan) {
  latencies.set(kLate, {Latencies::Learned::kMost, {1s, 2s, 1s}});
  latencies.cleared(kLate, 3s);
  EXPECT_EQ(latencies.learned(kLate),
            (Latencies::Learned{Latencies::Learned::kMost, {1s, 3s, 1s}}));
}

// Later evidence corrects the first.
TEST(Latencies, FailuresThatSpreadShowWhetherTheStatementIsKept) {
  using Statement = Latencies::Statement;
  const RuleSet rules = latency_rules();
  Latencies latencies(rules);
  EXPECT_EQ(latencies.statement(), Statement::kUnproven);
  EXPECT_EQ(latencies.lateness(kLate).most, 1s);
  EXPECT_EQ(latencies.reckon_with(kLate), 2s);
  latencies.weigh(-2);
  EXPECT_EQ(latencies.statement(), Statement::kKept);
  EXPECT_EQ(latencies.reckon_with(kLate), 1s);
  latencies.weigh(5);
  EXPECT_EQ(latencies.statement(), Statement::kExceeded);
  EXPECT_EQ(latencies.lateness(kLate), (Range{0s, 3s, 0s}));
  EXPECT_EQ(latencies.reckon_with(kOnTopic), 0s);
  latencies.weigh(-2);
  EXPECT_EQ(latencies.statement(), Statement::kExceeded) << "less evidence than that against it";
}

// A robot that is often repaired needs no failure that spreads.
TEST(Latencies, RepairsShowWhetherTheStatementIsKept) {
  const RuleSet rules = latency_rules();
  Latencies latencies(rules);
  latencies.set(kLate, {1, {400ms, 900ms, 400ms}});
  EXPECT_EQ(latencies.reckon_with(kLate), 1s);
  EXPECT_EQ(latencies.reckon_with(kOther), 2s);
  latencies.set(kLate, {1, {400ms, 4s, 400ms}});
  latencies.set(kOther, {1, {400ms, 4s, 400ms}});
  EXPECT_EQ(latencies.statement(), Latencies::Statement::kExceeded);
}

}  // namespace
}  // namespace culprit
