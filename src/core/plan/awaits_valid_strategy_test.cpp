#include "plan/awaits_valid_strategy.h"

#include <gtest/gtest.h>

#include "plan/bayes/test_scene.h"

namespace culprit::plan {
namespace {

// b has exited. The strategy that starts it again sets a parameter of a, too.
TEST(AwaitsValidStrategy, AlsoOfAStrategyThatDoesMoreThanToStartIt) {
  Scene scene(
      "COMPONENT a NODE /a\nCOMPONENT b NODE /b LAUNCH \"b\"\n"
      "RULE B\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY anew 50 10\nADAPTATION b redeploy 2\n"
      "ADAPTATION a set_parameter gain 1 2\n"
      "RULE Blurred\nPOLICIES ERROR\nTRIGGER y > 1\nSTRATEGY tune 50 10\n"
      "ADAPTATION b set_parameter gain 1 2\n");
  scene.fail("Blurred");
  scene.process("b", ProcessState::kGone);
  Candidate tune;
  tune.strategy = scene.strategy("Blurred.tune");
  tune.component = scene.component("b");
  tune.excluded = Condition::kInvalid;
  const Decision decision{scene.rule("Blurred"), {}, true, {tune}, {}};
  EXPECT_FALSE(awaits_valid_strategy(decision, *scene)) << "nothing repairs b";
  scene.fail("B");
  EXPECT_TRUE(awaits_valid_strategy(decision, *scene));
}

TEST(MakesPossible, WhatMakesTheWhenTrueOrBringsBackWhatIsDown) {
  Scene scene(
      "COMPONENT driver NODE /driver LAUNCH \"driver\"\n"
      "COMPONENT arm NODE /arm LAUNCH \"arm\"\n"
      "RULE Driver\nPOLICIES ERROR\nTRIGGER x > 1\n"
      "STRATEGY safe 50 10 WHEN lifecycle(arm) == \"inactive\"\nADAPTATION driver redeploy 2\n"
      "STRATEGY gentle 50 10\nADAPTATION arm set_parameter hold true 2\n"
      "RULE Arm\nPOLICIES ERROR\nTRIGGER y > 1\n"
      "STRATEGY off 50 10\nADAPTATION arm deactivate 2\n"
      "STRATEGY again 50 10\nADAPTATION arm redeploy 2\n");
  const auto makes = [&](const char* strategy, const char* waiting) {
    const Strategy& of = scene.rules()[scene.strategy(waiting)];
    const auto why = invalidity(of, *scene);
    return why && makes_possible(scene.rules()[scene.strategy(strategy)], of, *why, *scene);
  };
  EXPECT_TRUE(makes("Arm.off", "Driver.safe"));
  EXPECT_FALSE(makes("Arm.again", "Driver.safe"));
  EXPECT_FALSE(makes("Arm.again", "Driver.gentle")) << "it is possible now";
  scene.process("arm", ProcessState::kGone);
  EXPECT_TRUE(makes("Arm.again", "Driver.gentle"));
  EXPECT_FALSE(makes("Arm.off", "Driver.gentle"));
}

TEST(MakesPossible, WhatBringsUpTheGroupOfWhatIsNotActive) {
  Scene scene(
      "COMPONENT manager NODE /manager LAUNCH \"manager\"\n"
      "COMPONENT arm NODE /arm LAUNCH \"arm\"\n"
      "COMPONENT hand NODE /hand LAUNCH \"hand\"\n"
      "GROUP both { arm, hand } MANAGER manager\n"
      "RULE Both\nPOLICIES ERROR\nTRIGGER both == \"inactive\"\n"
      "STRATEGY start 50 10\nADAPTATION both start_group 2\n"
      "RULE Arm\nPOLICIES ERROR\nTRIGGER y > 1\n"
      "STRATEGY again 50 10\nADAPTATION arm redeploy 2\n");
  const Strategy& start = scene.rules()[scene.strategy("Both.start")];
  const Strategy& again = scene.rules()[scene.strategy("Arm.again")];
  const Invalid paused{again.components.front(), "its group is paused", true};
  EXPECT_FALSE(makes_possible(start, again, paused, *scene)) << "the arm is active";
  scene->components[scene.component("arm")].lifecycle = Lifecycle::kInactive;
  EXPECT_TRUE(makes_possible(start, again, paused, *scene));
}

}  // namespace
}  // namespace culprit::plan
