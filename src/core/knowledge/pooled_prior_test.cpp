#include "knowledge/pooled_prior.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit {
namespace {

struct Robot {
  double helped = 0;
  double failed = 0;
};

RobotOutcomes sums_of(const std::vector<Robot>& robots) {
  RobotOutcomes sums;
  for (const Robot& robot : robots) sums.add(robot.helped, robot.failed);
  return sums;
}

double strength(const Belief& belief) { return belief.alpha + belief.beta; }

Belief any_designer() {
  return initial_belief(percent(*rc::gen::inRange(1, 100)), *rc::gen::inRange(1, 100));
}

std::vector<Robot> any_robots() {
  std::vector<Robot> robots(*rc::gen::inRange<std::size_t>(0, 30));
  for (Robot& robot : robots) {
    robot.helped = *rc::gen::inRange(0, 200);
    robot.failed = *rc::gen::inRange(0, 200);
  }
  return robots;
}

TEST(PooledPrior, IsTheDesignersBeliefToTheLastBitWithoutOutcomes) {
  const Belief designer = initial_belief(percent(80), 50);
  EXPECT_EQ(pooled_prior(designer, {}, {}), designer);
  const RobotOutcomes none[3] = {};
  EXPECT_EQ(pooled_prior(designer, {}, none), designer);
}

TEST(PooledPrior, OfManyRobotsThatAgreeIsTheirRateAsStrongAsIsAllowed) {
  const RobotOutcomes model = sums_of(std::vector<Robot>(40, {2, 8}));
  const Belief prior = pooled_prior(initial_belief(percent(90), 20), model, {}, {.most = 10});
  EXPECT_NEAR(prior.mean().value, 0.2, 0.03);
  EXPECT_NEAR(strength(prior), 10, 1.5);
}

TEST(PooledPrior, IsWeakWhereRobotsDiffer) {
  std::vector<Robot> robots(20, {9, 1});
  robots.insert(robots.end(), 20, {1, 9});
  const Belief differing = pooled_prior(initial_belief(percent(50), 2), sums_of(robots), {});
  const Belief alike =
      pooled_prior(initial_belief(percent(50), 20), sums_of(std::vector<Robot>(40, {5, 5})), {});
  EXPECT_LT(strength(differing), 4);
  EXPECT_GT(strength(alike), 8);
}

TEST(PooledPrior, ListensToTheModelBeforeTheFleet) {
  const RobotOutcomes model = sums_of(std::vector<Robot>(10, {1, 9}));
  const RobotOutcomes others[] = {sums_of(std::vector<Robot>(500, {9, 1}))};
  const Belief designer = initial_belief(percent(50), 10);
  EXPECT_LT(pooled_prior(designer, model, others).mean().value, 0.3);
  EXPECT_GT(pooled_prior(designer, {}, others).mean().value, 0.65);
}

// However many outcomes one robot has, it is one.
TEST(PooledPrior, IsNotMadeByOneRobot) {
  std::vector<Robot> robots(20, {8, 2});
  const double before =
      pooled_prior(initial_belief(percent(80), 10), sums_of(robots), {}).mean().value;
  robots.push_back({0, 1e9});
  const double after =
      pooled_prior(initial_belief(percent(80), 10), sums_of(robots), {}).mean().value;
  EXPECT_LT(before - after, 0.2);
}

TEST(PooledPrior, TakesSumsThatNoOutcomesCanHaveForNone) {
  const Belief designer = initial_belief(percent(70), 10);
  const double nan = std::nan("");
  const double inf = std::numeric_limits<double>::infinity();
  for (const RobotOutcomes& odd :
       {RobotOutcomes{nan, nan, nan, nan, nan}, RobotOutcomes{1, 1, 1, 1, inf},
        RobotOutcomes{-1, 5, 2, 1, 5}, RobotOutcomes{1, 5, 9, 1, 5}, RobotOutcomes{1, 5, -2, 1, 5},
        RobotOutcomes{1, 1e300, 1, 1, 1}, RobotOutcomes{1, 5, 2, 4, 5}})
    EXPECT_EQ(pooled_prior(designer, odd, std::span(&odd, 1)), designer);
}

RC_GTEST_PROP(PooledPrior, IsNeverStrongerThanTheDesignerOrTheCap, ()) {
  const Belief designer = any_designer();
  const Pooling pooling{.most = 1.0 * *rc::gen::inRange(2, 30)};
  const std::vector<RobotOutcomes> others = {sums_of(any_robots()), sums_of(any_robots())};
  const Belief prior = pooled_prior(designer, sums_of(any_robots()), others, pooling);
  RC_ASSERT(prior.alpha > 0 && prior.beta > 0);
  RC_ASSERT(strength(prior) <= std::max(strength(designer), pooling.most) + 0.11);
}

RC_GTEST_PROP(PooledPrior, LiesBetweenAllThatItIsMadeOf, ()) {
  const Belief designer = any_designer();
  const std::vector<RobotOutcomes> all = {sums_of(any_robots()), sums_of(any_robots())};
  double low = designer.mean().value;
  double high = low;
  for (const RobotOutcomes& each : all) {
    if (each.tried <= 0) continue;
    low = std::min(low, each.helped / each.tried);
    high = std::max(high, each.helped / each.tried);
  }
  const double mean = pooled_prior(designer, all[0], std::span(all).subspan(1)).mean().value;
  // The least pseudo-count draws what is certain towards the middle.
  RC_ASSERT(mean >= low - 0.06 && mean <= high + 0.06);
}

RC_GTEST_PROP(PooledPrior, OfTheOthersIsWhatItWouldBeWithoutOneself, ()) {
  std::vector<Robot> robots = any_robots();
  RobotOutcomes with = sums_of(robots);
  const Robot own{1.0 * *rc::gen::inRange(0, 90), 1.0 * *rc::gen::inRange(0, 90)};
  with.add(own.helped, own.failed);
  with.remove(own.helped, own.failed);
  const Belief designer = any_designer();
  const Belief expected = pooled_prior(designer, sums_of(robots), {});
  const Belief prior = pooled_prior(designer, with, {});
  RC_ASSERT(std::abs(prior.alpha - expected.alpha) < 1e-6);
  RC_ASSERT(std::abs(prior.beta - expected.beta) < 1e-6);
}

RC_GTEST_PROP(PooledPrior, DoesNotDependOnTheOrderOfRobotsOrModels, ()) {
  std::vector<Robot> robots = any_robots();
  std::vector<RobotOutcomes> others = {sums_of(any_robots()), sums_of(any_robots()),
                                       sums_of(any_robots())};
  const Belief designer = any_designer();
  const Belief one = pooled_prior(designer, sums_of(robots), others);
  std::reverse(robots.begin(), robots.end());
  std::reverse(others.begin(), others.end());
  const Belief other = pooled_prior(designer, sums_of(robots), others);
  RC_ASSERT(std::abs(one.alpha - other.alpha) < 1e-6);
  RC_ASSERT(std::abs(one.beta - other.beta) < 1e-6);
}

TEST(Agreement, IsCertainWithoutOutcomes) { EXPECT_EQ(agreement({3, 1}, 0, 0), 1); }

// Beta(1, 1): each number of successes is as likely as any other.
TEST(Agreement, OfAUniformBeliefIsCertainWhateverHappens) {
  for (const double helped : {0, 3, 10})
    EXPECT_NEAR(agreement({1, 1}, helped, 10 - helped), 1, 1e-9);
}

// Beta(9, 1), three trials: 0 of 3 has the probability B(9, 4) / B(9, 1) = 1 / 220.
TEST(Agreement, IsTheChanceOfWhatIsAsImprobable) {
  EXPECT_NEAR(agreement({9, 1}, 0, 3), 1.0 / 220, 1e-9);
  EXPECT_NEAR(agreement({9, 1}, 3, 0), 1, 1e-9);
}

TEST(Agreement, FallsWithEachOutcomeThatIsNotExpected) {
  double last = 1;
  for (int failed = 1; failed < 20; ++failed) {
    const double now = agreement({10, 2}, 0, failed);
    EXPECT_LT(now, last);
    last = now;
  }
  EXPECT_LT(last, 1e-4);
}

}  // namespace
}  // namespace culprit
