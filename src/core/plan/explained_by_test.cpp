#include "plan/explained_by.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plan/bayes/test_scene.h"

namespace culprit::plan {
namespace {

using testing::ElementsAre;

// a -> b; far has nothing to do with them.
TEST(ExplainedBy, AreTheFailuresOfWhatDependsOnWhatIsAdapted) {
  Scene scene(failure_of("a", "A") + failure_of("b", "B") + failure_of("far", "Far") +
              "RULE Wide\nPOLICIES ERROR\nTRIGGER y > 1\nSTRATEGY tune 50 10\nADAPTATION b "
              "set_parameter gain 1 2\nADAPTATION far set_parameter gain 1 2\n");
  scene.link("a", "b").fail("A").fail("B").fail("Far").fail("Wide");
  EXPECT_THAT(explained_by(scene.strategy("A.restart"), *scene),
              ElementsAre(scene.rule("B"), scene.rule("Wide")));
}

}  // namespace
}  // namespace culprit::plan
