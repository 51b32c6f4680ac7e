#include "plan/bayes/responsibility.h"

#include <gtest/gtest.h>

#include "plan/bayes/suspicion.h"
#include "plan/bayes/test_scene.h"

namespace culprit::plan {
namespace {

using namespace std::chrono_literals;

constexpr double kPi = kCoincidence;
constexpr double kKappa = Coupling::kUsual;

// R_i of each failure that is there, by the name of its rule.
double responsibility(Scene& scene, const std::string& rule) {
  std::vector<ComponentId> all;
  for (const RuleId id : scene->states.active()) {
    const auto& touched = scene.rules()[id].components;
    all.insert(all.end(), touched.begin(), touched.end());
  }
  const Reach reach(*scene, all);
  const Failures failures(*scene, reach, FailurePaths(*scene, reach, suspicious_rules(*scene)));
  return Responsibility(*scene, failures).of(failures.index_of(scene.rule(rule)));
}

Scene chain() {
  Scene scene(failure_of("a", "A") + failure_of("b", "B") + failure_of("c", "C"));
  scene.link("a", "b").link("b", "c");
  return scene;
}

TEST(Reach, CountsWhoDependsOnAComponent) {
  Scene scene = chain();
  const Reach reach(*scene, {scene.component("a"), scene.component("b"), scene.component("c")});
  EXPECT_EQ(reach.dependents(reach.place_of(scene.component("a"))), 2u);
  EXPECT_EQ(reach.dependents(reach.place_of(scene.component("b"))), 1u);
  EXPECT_EQ(reach.dependents(reach.place_of(scene.component("c"))), 0u);
}

// However many read it: what is ill of them speaks for the way, not against it.
TEST(FailurePaths, AManyReadTopicCarriesFailuresWhereAllOfItsReadersAreIll) {
  std::string rules = failure_of("producer", "P") + failure_of("aside", "X");
  for (char c = 'a'; c < 'k'; ++c) rules += failure_of({c}, "R" + std::string(1, c));
  Scene scene(rules);
  scene->states.state(scene.rule("X")).detection.trigger =
      Slot::of(false);  // it is seen to be well
  scene.fail("P", -1h);
  for (char c = 'a'; c < 'k'; ++c) {
    scene.link("producer", {c});
    scene.fail("R" + std::string(1, c), -1h);
  }
  EXPECT_LT(responsibility(scene, "Ra"), 0.5);
  EXPECT_GT(responsibility(scene, "P"), 0.5);
}

TEST(RootProbability, IsTheNoisyOrsPosterior) {
  EXPECT_DOUBLE_EQ(root_probability(0.05, 0), 1) << "nothing else explains it";
  EXPECT_DOUBLE_EQ(root_probability(0.05, 0.95), 0.05 / (0.05 + 0.95 * 0.95));
  EXPECT_DOUBLE_EQ(root_probability(0.05, 1), 0.05);
}

TEST(Responsibility, FallsToTheFailureThatNothingIsUpstreamOf) {
  Scene scene = chain();
  scene.fail("A").fail("B").fail("C");
  EXPECT_DOUBLE_EQ(responsibility(scene, "A"), 1);
  EXPECT_DOUBLE_EQ(responsibility(scene, "B"), root_probability(kPi, kKappa));
  EXPECT_DOUBLE_EQ(responsibility(scene, "C"),
                   root_probability(kPi, 1 - (1 - kKappa) * (1 - kKappa)));
}

TEST(Responsibility, LooksThroughHealthyComponents) {
  Scene scene = chain();
  scene.fail("A").fail("C");
  EXPECT_DOUBLE_EQ(responsibility(scene, "C"), root_probability(kPi, kKappa));
}

TEST(Responsibility, FollowsWhatWasLearned) {
  Scene scene = chain();
  scene.fail("A").fail("B");
  scene->couplings.set(scene.rule("A"), scene.rule("B"), {1, 9});
  const double kappa = (2 * kKappa + 1) / 12;
  EXPECT_DOUBLE_EQ(responsibility(scene, "B"), root_probability(kPi, kappa));
}

TEST(Responsibility, IsTakenFromAFailureByALesserOneToo) {
  Scene scene(failure_of("a", "A", "WARNING") + failure_of("b", "B"));
  scene.link("a", "b").fail("A").fail("B");
  EXPECT_DOUBLE_EQ(responsibility(scene, "B"), root_probability(kPi, kKappa));
}

TEST(Responsibility, RisesWhenTheProcessIsSeenDown) {
  Scene scene = chain();
  scene.fail("A").fail("B");
  scene.process("b", ProcessState::kStopped);
  EXPECT_DOUBLE_EQ(responsibility(scene, "B"), root_probability(kSeenDown, kKappa));
}

TEST(Responsibility, IsSharedInACircle) {
  Scene scene = chain();
  scene.link("c", "a").fail("A").fail("B").fail("C");
  const double third = 1.0 / 3 + 2.0 / 3 * kPi;
  EXPECT_NEAR(responsibility(scene, "A"), third, 1e-12);
  EXPECT_NEAR(responsibility(scene, "C"), third, 1e-12);
}

TEST(Responsibility, InACircleFallsToWhoWasNotAdaptedInVain) {
  Scene scene = chain();
  scene.link("c", "a").fail("A").fail("B").fail("C");
  scene.tried("A.restart");
  const double still_there = 1 - 0.5;
  const double omega = still_there / (still_there + 2);
  EXPECT_NEAR(responsibility(scene, "A"), omega + (1 - omega) * kPi, 1e-12);
}

TEST(Responsibility, InACircleFallsToWhoFailedFirst) {
  Scene scene = chain();
  scene.link("c", "a").fail("A", 400ms).fail("B").fail("C", 200ms);  // a cycle is 200 ms
  const double sum = 1.0 / 3 + 1 + 1.0 / 2;
  const double omega = 1 / sum;
  EXPECT_NEAR(responsibility(scene, "B"), omega + (1 - omega) * kPi, 1e-12);
}

TEST(Responsibility, OfACircleIsExplainedByWhatIsUpstreamOfIt) {
  Scene scene = chain();
  scene.link("c", "b").fail("A").fail("B").fail("C");
  const double half = 0.5 + 0.5 * kPi;
  EXPECT_DOUBLE_EQ(responsibility(scene, "A"), 1);
  EXPECT_NEAR(responsibility(scene, "B"), root_probability(kPi, kKappa) * half, 1e-12);
}

TEST(Responsibility, SharesWhatIsExplained) {
  Scene scene = chain();
  scene.fail("A").fail("B").fail("C");
  std::vector<ComponentId> all{scene.component("a"), scene.component("b"), scene.component("c")};
  const Reach reach(*scene, all);
  const Failures failures(*scene, reach, FailurePaths(*scene, reach, suspicious_rules(*scene)));
  const Responsibility r(*scene, failures);
  EXPECT_NEAR(r.share(0, 2) + r.share(1, 2), 1 - r.of(2), 1e-12);
  EXPECT_NEAR(r.share(0, 2) / r.share(1, 2), r.of(0) / r.of(1), 1e-9);
  EXPECT_EQ(r.share(2, 0), 0);
}

}  // namespace
}  // namespace culprit::plan
