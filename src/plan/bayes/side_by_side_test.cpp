#include "plan/bayes/side_by_side.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plan/bayes/bayes_planner.h"
#include "plan/bayes/test_scene.h"

namespace culprit::plan {
namespace {

using testing::ElementsAre;

constexpr Word kHere = 1;
constexpr Word kThere = 2;

std::span<const Word> at(const Word& place) { return {&place, 1}; }

// A quick try and one that takes long and helps; it is over no later than what is done elsewhere.
TEST(SideBySide, TakesWhatHelpsWhileTheRobotWaitsAnyway) {
  const std::vector<Timed> options = {{0, 0.35, 0.1, at(kHere)},  // 0.1, and often 0.3 after it
                                      {0, 0.40, 0.3, at(kHere)},  // helps
                                      {1, 0.50, 0.3, at(kThere)}};
  EXPECT_THAT(side_by_side(options, {0, 2}), ElementsAre(1, 2));
  EXPECT_THAT(side_by_side(options, {0}), ElementsAre(0)) << "nobody else takes time";
}

TEST(SideBySide, CountsTheTimeBeyondThatOfTheOthers) {
  const std::vector<Timed> options = {
      {0, 0.35, 0.1, at(kHere)}, {0, 0.50, 0.3, at(kHere)}, {1, 0.20, 0.15, at(kThere)}};
  EXPECT_THAT(side_by_side(options, {0, 2}), ElementsAre(0, 2)) << "0.25 beside 0.35";
}

TEST(SideBySide, StaysAtTheComponentsThatWereChosen) {
  const std::vector<Timed> options = {
      {0, 0.35, 0.1, at(kHere)}, {0, 0.30, 0.3, at(kThere)}, {1, 0.50, 0.3, at(kThere)}};
  EXPECT_THAT(side_by_side(options, {0, 2}), ElementsAre(0, 2));
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
