#include "plan/beside_exhausted.h"

#include <gtest/gtest.h>

#include "plan/bayes/bayes_planner.h"
#include "plan/bayes/test_scene.h"
#include "plan/paper_planner.h"

namespace culprit::plan {
namespace {

// a -> b, and only a person can repair a.
Scene given_up() {
  Scene scene(failure_of("a", "A") + failure_of("b", "B"));
  scene.link("a", "b").exhaust("A").fail("B");
  scene->states.state(scene.rule("A")).detection.trigger = Slot::of(true);
  return scene;
}

TEST(BesideExhausted, AFailureWaitsForThePersonIfNothingElseIsLeft) {
  Scene scene = given_up();
  scene.tried("B.restart");
  scene.plan(BayesPlanner());
  Decision decision = scene.decision("B");
  EXPECT_TRUE(waits_for_person(decision, *scene)) << "one was tried, the other waits";
  for (Candidate& each : decision.candidates) each.excluded = Condition::kTried;
  EXPECT_FALSE(waits_for_person(decision, *scene)) << "it waits for its next round";
}

TEST(BesideExhausted, ThePaperNamesTheComponentThatThePersonHasToLookAt) {
  Scene scene = given_up();
  EXPECT_EQ(scene.plan(PaperPlanner()), "");
  EXPECT_EQ(scene.candidate("B.redeploy").excluded, Condition::kDependency);
  EXPECT_EQ(scene.candidate("B.redeploy").component, scene.component("a"));
}

// The computer of a is silent, so no strategy reaches a; b is well, and waits for it.
TEST(BesideExhausted, AFailureWaitsForAComputerThatIsSilent) {
  Scene scene("COMPONENT a NODE /a\n" + failure_of("b", "B"));
  scene.link("a", "b").fail("B");
  EXPECT_NE(scene.plan(BayesPlanner()), "");
  scene->components.set_host_silent(scene.component("a"), scene->now);
  EXPECT_EQ(scene.plan(BayesPlanner()), "");
  EXPECT_EQ(scene.candidate("B.redeploy").excluded, Condition::kUnheard);
  EXPECT_TRUE(waits_for_person(scene.decision("B"), *scene));
}

}  // namespace
}  // namespace culprit::plan
