#include "plan/ties.h"

#include <gtest/gtest.h>

#include "plan/bayes/test_scene.h"
#include "plan/paper_planner.h"

namespace culprit::plan {
namespace {

TEST(Parts, OfSumsOfTheSameNumbersAreTheSame) {
  EXPECT_NE((1 - 0.8) + 7.0 / 30, (1 - 0.7) + 4.0 / 30);
  EXPECT_EQ(parts((1 - 0.8) + 7.0 / 30), parts((1 - 0.7) + 4.0 / 30));
  EXPECT_EQ(parts(0.1 + 0.2), parts(0.3));
  EXPECT_LT(parts(0.3), parts(0.300001));
}

TEST(Parts, HaveABound) {
  EXPECT_EQ(parts(1e300), parts(0x1p30));
  EXPECT_EQ(parts(-1e300), -parts(0x1p30));
  EXPECT_LT(parts(0x1p29), parts(0x1p30));
}

// Both cost 0.4333...: 80 % in 7 cycles, and 70 % in 4, of 30 at most.
Scene equal_costs(const std::string& sooner, const std::string& likelier) {
  Scene scene("COMPONENT a NODE /a LAUNCH \"a\"\nRULE A\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY " +
              likelier + " 80 10\nADAPTATION a set_parameter p 1 7\nSTRATEGY " + sooner +
              " 70 10\nADAPTATION a set_parameter p 2 4\n"
              "STRATEGY z 1 10\nADAPTATION a redeploy 30\n");
  scene.fail("A");
  return scene;
}

TEST(PaperPlanner, TellsEqualCostsApartByName) {
  EXPECT_EQ(equal_costs("s", "t").plan(PaperPlanner()), "A.s");
  EXPECT_EQ(equal_costs("t", "s").plan(PaperPlanner()), "A.s");
}

}  // namespace
}  // namespace culprit::plan
