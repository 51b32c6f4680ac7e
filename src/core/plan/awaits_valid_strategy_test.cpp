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

}  // namespace
}  // namespace culprit::plan
