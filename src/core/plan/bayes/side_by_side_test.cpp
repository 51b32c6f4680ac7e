#include "plan/bayes/side_by_side.h"

#include <cstdint>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plan/bayes/bayes_planner.h"
#include "plan/bayes/test_scene.h"
#include "plan/ties.h"

namespace culprit::plan {
namespace {

using testing::ElementsAre;

// Chance, cost and the part of it that its time is.
const Try kQuick{0.5, 0.11, 0.1};
const Try kThorough{0.9, 0.31, 0.3};

TEST(JointCost, OfOneSideIsItsExpectedCost) {
  const std::vector<Side> one = {{{kQuick, kThorough}, {0, 1}}};
  const std::vector<std::size_t> quick = {0};
  const std::vector<std::size_t> thorough = {1};
  EXPECT_NEAR(joint_cost(one, quick), 0.11 + 0.5 * 0.31, 1e-12);
  EXPECT_NEAR(joint_cost(one, thorough), 0.31 + 0.1 * 0.11, 1e-12);
}

// By hand: 0.01 for each try, the time of the longest that is still needed.
TEST(JointCost, OfTwoSidesCountsTheLongerOfTheirTimes) {
  const std::vector<Side> two = {{{kQuick, kThorough}, {0}}, {{kQuick, kThorough}, {0}}};
  const std::vector<std::size_t> quick = {0, 0};
  const double second = 2 * 0.5 * 0.01 + 0.3 * (1 - 0.5 * 0.5);
  EXPECT_NEAR(joint_cost(two, quick), 2 * 0.01 + 0.1 + second, 1e-12);
}

TEST(SideBySide, TakesTheUsualOneAlone) {
  const std::vector<Side> one = {{{kQuick, kThorough}, {0, 1}}};
  EXPECT_THAT(side_by_side(one), ElementsAre(0));
}

// A quick try and one that takes long and helps; it is over no later than what is done elsewhere.
TEST(SideBySide, TakesWhatHelpsWhileTheRobotWaitsAnyway) {
  const std::vector<Side> sides = {{{kQuick, kThorough}, {0, 1}}, {{kThorough}, {0}}};
  EXPECT_THAT(side_by_side(sides), ElementsAre(1, 0));
}

// Alone each would be tried quickly first; neither alone is better, both are.
TEST(SideBySide, ReplacesTwoAtOnce) {
  const Try quick{0.55, 0.16, 0.15};
  const std::vector<Side> sides = {{{quick, kThorough}, {0, 1}}, {{quick, kThorough}, {0, 1}}};
  EXPECT_THAT(side_by_side(std::span(sides).first(1)), ElementsAre(0));
  const std::vector<std::size_t> usual = {0, 0};
  const std::vector<std::size_t> one = {1, 0};
  EXPECT_LT(joint_cost(sides, usual), joint_cost(sides, one));
  EXPECT_THAT(side_by_side(sides), ElementsAre(1, 1));
}

TEST(SideBySide, OfEquallyGoodOnesIsTheUsual) {
  const Side either{{kQuick, kQuick}, {0, 1}};
  EXPECT_THAT(side_by_side(std::vector<Side>(2, either)), ElementsAre(0, 0));
}

TEST(SideBySide, BeginsOnlyWithWhatItMay) {
  const std::vector<Side> sides = {{{kQuick, kThorough}, {0}}, {{kThorough}, {0}}};
  EXPECT_THAT(side_by_side(sides), ElementsAre(0, 0));
}

TEST(SideBySide, OfVeryManyFindsWhatIsBetterOneByOne) {
  std::vector<Side> sides(30, {{kQuick, kThorough}, {0, 1}});
  sides.push_back({{kThorough}, {0}});
  for (const std::size_t begin : side_by_side(std::span(sides).first(30))) EXPECT_EQ(begin, 1u);
}

// Sides with tries of any kind, too many for all combinations.
std::vector<Side> many_sides(std::uint32_t& state) {
  const auto draw = [&] {
    state = state * 1664525 + 1013904223;
    return static_cast<double>(state >> 16) / 65536;
  };
  std::vector<Side> sides(10);
  for (Side& side : sides) {
    for (std::size_t i = 0; i < 3; ++i) {
      const double time = 0.05 + 0.5 * draw();
      side.tries.push_back({0.1 + 0.8 * draw(), time + 0.1 * draw(), time});
      side.firsts.push_back(i);
    }
  }
  return sides;
}

TEST(SideBySide, OfManyNoChangeAtOneSideAloneIsBetter) {
  std::uint32_t state = 1;
  for (int draw = 0; draw < 50; ++draw) {
    const std::vector<Side> sides = many_sides(state);
    const std::vector<std::size_t> found = side_by_side(sides);
    for (std::size_t i = 0; i < sides.size(); ++i) {
      for (const std::size_t first : sides[i].firsts) {
        std::vector<std::size_t> changed = found;
        changed[i] = first;
        EXPECT_GE(parts(joint_cost(sides, changed)), parts(joint_cost(sides, found))) << draw;
      }
    }
  }
}

// a is restarted first if it is alone; while d has to be redeployed, a is, too.
TEST(SideBySide, IsHowTheBayesPlannerBeginsSeveralStrategies) {
  const BayesPlanner downtime(Objective::kDowntime);
  Scene scene(failure_of("a", "A") + failure_of("d", "D"));
  scene.fail("A");
  EXPECT_EQ(scene.plan(downtime), "A.restart");
  scene.fail("D").tried("D.restart");
  EXPECT_EQ(scene.plan(downtime), "A.redeploy D.redeploy");
  EXPECT_EQ(scene.candidate("A.restart").excluded, Condition::kOneEach);
}

}  // namespace
}  // namespace culprit::plan
