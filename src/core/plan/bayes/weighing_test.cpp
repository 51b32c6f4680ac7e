// The worth of a strategy, and its effect on its component.
#include <gtest/gtest.h>

#include "plan/bayes/bayes_planner.h"
#include "plan/bayes/exclusions.h"
#include "plan/bayes/test_scene.h"

namespace culprit::plan {
namespace {

constexpr const char* kWeighed =
    "COMPONENT a NODE /a LAUNCH \"a\"\nCOMPONENT b NODE /b LAUNCH \"b\"\n"
    "RULE Seldom\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY tune 20 10\n"
    "ADAPTATION a set_parameter gain 1 2\n"
    "RULE Mostly\nPOLICIES ERROR\nTRIGGER y > 1\nSTRATEGY both 90 10\n"
    "ADAPTATION b set_parameter gain 1 2\nADAPTATION a restart 2\n";

TEST(Weighing, WhatSeldomHelpsIsWorthLess) {
  Scene scene(kWeighed);
  scene.fail("Seldom").fail("Mostly");
  scene.plan(BayesPlanner());
  EXPECT_LT(scene.candidate("Seldom.tune").value, scene.candidate("Mostly.both").value);
}

TEST(Weighing, AStrategyTakesDownIfAnyOfItsAdaptationsDoes) {
  Scene scene(kWeighed);
  EXPECT_TRUE(takes_down(scene.rules()[scene.strategy("Mostly.both")]));
  EXPECT_FALSE(takes_down(scene.rules()[scene.strategy("Seldom.tune")]));
}

TEST(Weighing, WhatIsWithheldNamesItsComponent) {
  Scene scene(failure_of("a", "A") + failure_of("b", "B"));
  scene.fail("B");
  scene->withheld[scene.strategy("B.restart").index].reason = "once is enough";
  scene.plan(BayesPlanner());
  EXPECT_EQ(scene.candidate("B.restart").excluded, Condition::kWithheld);
  EXPECT_EQ(scene.candidate("B.restart").component, scene.component("b"));
}

}  // namespace
}  // namespace culprit::plan
