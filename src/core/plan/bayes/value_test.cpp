#include "plan/bayes/value.h"

#include <algorithm>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "diagnose/still_there.h"
#include "plan/bayes/strategy_chances.h"
#include "plan/bayes/test_scene.h"

namespace culprit::plan {
namespace {

using namespace std::chrono_literals;

std::vector<double> chances(const Scene& scene, Knowledge& knowledge, const std::string& rule) {
  std::vector<double> all;
  const auto troubles = diagnose::all_troubles(knowledge);
  for (const StrategyChance& each : strategy_chances(scene.rule(rule), troubles, knowledge))
    all.push_back(each.chance);
  return all;
}

TEST(StrategyChances, AreTheBeliefsWhileNothingWasTried) {
  Scene scene(failure_of("a", "A"));
  EXPECT_EQ(chances(scene, *scene, "A"), (std::vector<double>{0.5, 0.9}));
}

TEST(StrategyChances, GrowLikelierWithEachThatFailed) {
  Scene scene(
      "COMPONENT a NODE /a\nRULE A\nPOLICIES ERROR\nTRIGGER x > 1\n"
      "STRATEGY s 60 10\nADAPTATION a set_parameter p 1 2\n"
      "STRATEGY t 30 10\nADAPTATION a set_parameter p 2 2\n"
      "STRATEGY u 5 10\nADAPTATION a set_parameter p 3 2\n");
  scene.tried("A.s");
  const auto left = chances(scene, *scene, "A");
  EXPECT_EQ(left[0], 0);
  EXPECT_DOUBLE_EQ(left[1], 0.3 / 0.4);
  EXPECT_DOUBLE_EQ(left[2], 0.05 / 0.4);
}

// Restart and redeploy help against much of the same: beliefs of 28, 43 and 90 %.
const std::string kOverlapping =
    "COMPONENT a NODE /a LAUNCH \"a\"\nRULE A\nPOLICIES ERROR\nTRIGGER x > 1\n"
    "STRATEGY configure 28 10\nADAPTATION a set_parameter p 1 2\n"
    "STRATEGY restart 43 10\nADAPTATION a restart 5\n"
    "STRATEGY redeploy 90 10\nADAPTATION a redeploy 15\n";

TEST(StrategyChances, HelpLessOnceOneFailedThatHelpsAgainstTheSame) {
  Scene scene(kOverlapping);
  EXPECT_THAT(chances(scene, *scene, "A"),
              testing::ElementsAre(testing::DoubleNear(0.28, 1e-9), testing::DoubleNear(0.43, 1e-9),
                                   testing::DoubleNear(0.9, 1e-9)));
  scene.tried("A.redeploy");
  const auto left = chances(scene, *scene, "A");
  EXPECT_NEAR(left[0], 0.47, 0.01);
  EXPECT_NEAR(left[1], 0.69, 0.01);
}

TEST(StrategyChances, SayHowLikelyWhatIsWrongOutlivesThem) {
  Scene scene(kOverlapping);
  EXPECT_DOUBLE_EQ(diagnose::still_there(scene.rule("A"), *scene), 1);
  scene.tried("A.redeploy");
  EXPECT_NEAR(diagnose::still_there(scene.rule("A"), *scene), 0.1, 1e-9);
  Scene other(kOverlapping);
  other.tried("A.configure").tried("A.restart");
  EXPECT_NEAR(diagnose::still_there(other.rule("A"), *other), 0.38, 0.01);
  Scene again(kOverlapping);
  (*again).states.state(again.rule("A")).search.round = 1;
  EXPECT_NEAR(diagnose::still_there(again.rule("A"), *again), 0.72 * 0.57 * 0.1, 1e-9);
}

TEST(StrategyChances, ReplaceAProcessThatIsDown) {
  Scene scene(
      "COMPONENT a NODE /a LAUNCH \"a\"\nCOMPONENT b NODE /b\nRULE A\nPOLICIES ERROR\n"
      "TRIGGER x > 1\n"
      "STRATEGY replace 50 10\nADAPTATION a redeploy 2\n"
      "STRATEGY bypass 50 10\nADAPTATION b set_parameter p 2 2\n");
  scene.process("a", ProcessState::kGone);
  const auto left = chances(scene, *scene, "A");
  EXPECT_DOUBLE_EQ(left[0], 0.5);
  EXPECT_DOUBLE_EQ(left[1], 0.5 * kUnlikely);
}

TEST(TryCost, AddsWhatAStrategyTakes) {
  Scene scene(failure_of("a", "A"));  // the heaviest impact is 10 cycles of 200 ms
  const CostWeights weights{.time = 1, .attempt = 2, .redeployment = 4, .disruption = 8};
  EXPECT_DOUBLE_EQ(try_cost({Cycles{5}, 1s, 1, 0.5}, weights, scene.rules()), 1 + 2 + 4 + 4);
}

TEST(ExpectedCosts, CountTheOthersAsLongAsTheyFail) {
  const std::vector<Try> tries{{0.5, 1}, {0.3, 2}, {0.1, 4}};
  const auto costs = expected_costs(tries);
  EXPECT_DOUBLE_EQ(costs[0], 1 + 0.5 * 2 + 0.2 * 4);
  EXPECT_DOUBLE_EQ(costs[1], 2 + 0.7 * 1 + 0.2 * 4);
  EXPECT_DOUBLE_EQ(costs[2], 4 + 0.9 * 1 + 0.4 * 2);
}

TEST(ExpectedCosts, CountThatOneMayHelpByLuck) {
  StillThere still_there;
  const Try lucky{0.6, 1, 0, 0.2};  // its own: 0.5
  still_there.fails(lucky);
  EXPECT_DOUBLE_EQ(still_there.chance(), 0.4);
  still_there.fails({0.5, 1, 0, 0.2});  // its own: 0.375
  EXPECT_DOUBLE_EQ(still_there.chance(), 0.125 * 0.64);
}

// The p/c index: no order of the strategies is cheaper than that of u/c. Every order is tried.
RC_GTEST_PROP(ExpectedCosts, AreLowestInTheOrderOfTheIndex, ()) {
  const int count = *rc::gen::inRange(1, 6);
  std::vector<Try> tries;
  double left = 1;
  for (int i = 0; i < count; ++i) {
    const double chance = left * *rc::gen::inRange(1, 100) / 100.0;
    left -= chance;
    tries.push_back({chance, *rc::gen::inRange(1, 100) / 10.0});
  }
  std::sort(tries.begin(), tries.end(),
            [](const Try& a, const Try& b) { return index(a) > index(b); });
  std::vector<std::size_t> order(tries.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  double cheapest = 1e9;
  do {
    double cost = 0;
    double still_there = 1;
    for (const std::size_t i : order) {
      cost += still_there * tries[i].cost;
      still_there -= tries[i].chance;
    }
    cheapest = std::min(cheapest, cost);
  } while (std::next_permutation(order.begin(), order.end()));
  const auto costs = expected_costs(tries);
  RC_ASSERT(std::abs(costs.front() - cheapest) < 1e-9);
  RC_ASSERT(
      std::is_sorted(costs.begin(), costs.end(), [](double a, double b) { return a < b - 1e-9; }) ||
      costs.front() <= *std::min_element(costs.begin(), costs.end()) + 1e-9);
}

TEST(Objective, IsReadByItsName) {
  for (const auto* name : {"balanced", "downtime", "adaptations", "redeployments"})
    EXPECT_EQ(to_string(*parse_objective(name)), name);
  EXPECT_EQ(parse_objective("speed").error(),
            "there is no objective 'speed'; there are balanced, downtime, adaptations, "
            "redeployments");
}

}  // namespace
}  // namespace culprit::plan
