#include "diagnose/diagnosis.h"

#include <gtest/gtest.h>

#include "diagnose/examination.h"
#include "diagnose/known_down.h"
#include "plan/bayes/test_scene.h"

namespace culprit::diagnose {
namespace {

using namespace std::chrono_literals;
using plan::failure_of;
using plan::Scene;

constexpr double kPi = kCoincidence;
constexpr double kKappa = Coupling::kUsual;

// R_i of a failure that is there, by the name of its rule.
double own(Scene& scene, const std::string& rule) {
  const Examination found(*scene, scene->states.active());
  return found.diagnosis().of(found.causes().index_of(scene.rule(rule)));
}

Scene chain() {
  Scene scene(failure_of("a", "A") + failure_of("b", "B") + failure_of("c", "C"));
  scene.link("a", "b").link("b", "c");
  return scene;
}

TEST(Reach, CountsConsumersOfAComponent) {
  Scene scene = chain();
  const Reach reach(*scene, {scene.component("a"), scene.component("b"), scene.component("c")});
  EXPECT_EQ(reach.dependents(reach.place_of(scene.component("a"))), 2u);
  EXPECT_EQ(reach.dependents(reach.place_of(scene.component("b"))), 1u);
  EXPECT_EQ(reach.dependents(reach.place_of(scene.component("c"))), 0u);
}

// However many nodes read it: failures of its readers are evidence for the path, not against it.
TEST(Paths, AManyReadTopicCarriesFailuresWhereAllOfItsReadersAreIll) {
  std::string rules = failure_of("producer", "P") + failure_of("aside", "X");
  for (char c = 'a'; c < 'k'; ++c) rules += failure_of({c}, "R" + std::string(1, c));
  Scene scene(rules);
  scene.see_working("X");
  scene.fail("P", -1h);
  for (char c = 'a'; c < 'k'; ++c) {
    scene.link("producer", {c});
    scene.fail("R" + std::string(1, c), -1h);
  }
  EXPECT_LT(own(scene, "Ra"), 0.5);
  EXPECT_GT(own(scene, "P"), 0.5);
}

// Its memory is in order, and nothing comes through it.
TEST(Paths, AreNotCutByARuleThatTellsNothingOfData) {
  const auto own_of = [](const std::string& trigger) {
    std::string middle = failure_of("b", "B");
    middle.replace(middle.find("x > 1"), 5, trigger);
    Scene scene(failure_of("a", "A") + middle + failure_of("c", "C"));
    scene.link("a", "b").link("b", "c").fail("A", -1h).fail("C", -1h);
    scene.see_working("B");
    return own(scene, "C");
  };
  EXPECT_DOUBLE_EQ(own_of("y > 1"), 1);
  EXPECT_DOUBLE_EQ(own_of("memory(b) > 100"), own_cause(kPi, kKappa));
}

TEST(OwnCause, IsTheNoisyOrsPosterior) {
  EXPECT_DOUBLE_EQ(own_cause(0.05, 0), 1) << "nothing else explains it";
  EXPECT_DOUBLE_EQ(own_cause(0.05, 0.95), 0.05 / (0.05 + 0.95 * 0.95));
  EXPECT_DOUBLE_EQ(own_cause(0.05, 1), 0.05);
}

TEST(Diagnosis, FallsToTheFailureWithNoFailureUpstream) {
  Scene scene = chain();
  scene.fail("A").fail("B").fail("C");
  EXPECT_DOUBLE_EQ(own(scene, "A"), 1);
  EXPECT_DOUBLE_EQ(own(scene, "B"), own_cause(kPi, kKappa));
  EXPECT_DOUBLE_EQ(own(scene, "C"), own_cause(kPi, 1 - (1 - kKappa) * (1 - kKappa)));
}

// The camera was given up long before, by one rule or by two: it is one cause, and one that hardly explains what
// fails now.
TEST(Diagnosis, TwoExhaustedFailuresOfAComponentAreOneCause) {
  const auto own_of = [](const std::string& second_on) {
    Scene scene(failure_of("a", "A") + failure_of("b", "B") +
                "COMPONENT aside NODE /aside\nRULE Again\nPOLICIES ERROR\nTRIGGER y > 1\n"
                "STRATEGY again 50 10\nADAPTATION " +
                second_on + " restart 2\n");
    scene.link("a", "b").link("aside", "b").exhaust("A").exhaust("Again").fail("B");
    for (const std::string rule : {"A", "Again"})
      scene->states.state(scene.rule(rule)).onset = Onset{Time(20s), Time(20s)};
    scene->states.state(scene.rule("B")).worked_until = Time(85s);
    return own(scene, "B");
  };
  const double passes = kKappa * 5 / 65;
  EXPECT_DOUBLE_EQ(own_of("a"), own_cause(kPi, passes));
  EXPECT_DOUBLE_EQ(own_of("aside"), own_cause(kPi, 1 - (1 - passes) * (1 - passes)));
}

// The second rule takes nothing from what another cause explains.
TEST(Diagnosis, ASecondExhaustedFailureOfAComponentHasNoShare) {
  Scene scene(failure_of("a", "A") + failure_of("b", "B") +
              "RULE Again\nPOLICIES ERROR\nTRIGGER y > 1\nSTRATEGY again 50 10\n"
              "ADAPTATION a restart 2\n");
  scene.link("a", "b").exhaust("A").exhaust("Again").fail("B");
  const Examination found(*scene, scene->states.active());
  const auto share_of = [&](const std::string& rule) {
    return found.diagnosis().share(found.causes().index_of(scene.rule(rule)),
                                   found.causes().index_of(scene.rule("B")));
  };
  EXPECT_DOUBLE_EQ(share_of("A"), 1 - own_cause(kPi, kKappa));
  EXPECT_EQ(share_of("Again"), 0);
}

// A began after B. It explains B only if B outlasts an earlier cause, or its own new beginning.
TEST(Diagnosis, AnEffectThatOutlastsItsFirstCauseMayHaveALaterOne) {
  Scene scene = chain();
  scene.fail("A").fail("B");
  const Time b = scene->now - 10s;
  const Time a = scene->now - 3s;
  scene->states.state(scene.rule("B")).onset = Onset{b, b};
  scene->states.state(scene.rule("A")).onset = Onset{a, a};
  EXPECT_DOUBLE_EQ(own(scene, "B"), 1);
  scene->states.state(scene.rule("B")).masked_until = scene->now - 2s;
  EXPECT_DOUBLE_EQ(own(scene, "B"), own_cause(kPi, kKappa));
  scene->states.state(scene.rule("B")).masked_until = scene->now - 9s;
  EXPECT_DOUBLE_EQ(own(scene, "B"), 1) << "its echo was over, too";
  scene->components[scene.component("b")].process_since = scene->now - 2s;
  EXPECT_DOUBLE_EQ(own(scene, "B"), own_cause(kPi, kKappa));
}

// Its process had exited by then, whenever its rule fired. Without that it began too late.
TEST(Diagnosis, AFailureBeginsWithTheEndOfItsProcess) {
  const auto own_after = [](Time exited) {
    Scene scene = chain();
    scene.fail("A").fail("B");
    scene->states.state(scene.rule("A")).onset = Onset{Time(95s), Time(95s)};
    scene->states.state(scene.rule("B")).onset = Onset{Time(86s), Time(86s)};
    scene.process("a", ProcessState::kGone);
    scene->components[scene.component("a")].process_since = exited;
    return own(scene, "B");
  };
  EXPECT_LT(own_after(Time(85s)), 0.5);
  EXPECT_DOUBLE_EQ(own_after(Time(94s)), 1);
}

TEST(Diagnosis, LooksThroughHealthyComponents) {
  Scene scene = chain();
  scene.fail("A").fail("C");
  EXPECT_DOUBLE_EQ(own(scene, "C"), own_cause(kPi, kKappa));
}

TEST(Diagnosis, FollowsWhatWasLearned) {
  Scene scene = chain();
  scene.fail("A").fail("B");
  scene->couplings.set(scene.rule("A"), scene.rule("B"), {1, 9});
  const double kappa = (2 * kKappa + 1) / 12;
  EXPECT_DOUBLE_EQ(own(scene, "B"), own_cause(kPi, kappa));
}

// After a long time beside it without an effect it explains none, until it is seen to.
TEST(Diagnosis, OneOutcomeRefutesAllExposure) {
  Scene scene = chain();
  scene.fail("A").fail("B");
  scene->couplings.set(scene.rule("A"), scene.rule("B"), {0, 0, 1000});
  EXPECT_GT(own(scene, "B"), 0.5);
  scene->couplings.cleared(scene.rule("A"), scene.rule("B"));
  EXPECT_LT(own(scene, "B"), 0.5);
}

TEST(Diagnosis, IsTakenFromAFailureByALesserOneToo) {
  Scene scene(failure_of("a", "A", "WARNING") + failure_of("b", "B"));
  scene.link("a", "b").fail("A").fail("B");
  EXPECT_DOUBLE_EQ(own(scene, "B"), own_cause(kPi, kKappa));
}

TEST(Diagnosis, RisesWhenTheProcessIsKnownDown) {
  Scene scene = chain();
  scene.fail("A").fail("B");
  scene.process("b", ProcessState::kStopped);
  EXPECT_DOUBLE_EQ(own(scene, "B"), own_cause(kKnownDown, kKappa));
}

TEST(Diagnosis, IsSharedInAFeedbackLoop) {
  Scene scene = chain();
  scene.link("c", "a").fail("A").fail("B").fail("C");
  const double third = 1.0 / 3 + 2.0 / 3 * kPi;
  EXPECT_NEAR(own(scene, "A"), third, 1e-12);
  EXPECT_NEAR(own(scene, "C"), third, 1e-12);
}

TEST(Diagnosis, InALoopFallsToAComponentThatWasNotAdaptedInVain) {
  Scene scene = chain();
  scene.link("c", "a").fail("A").fail("B").fail("C");
  scene.tried("A.restart");
  const double still_there = 1 - 0.5;
  const double omega = still_there / (still_there + 2);
  EXPECT_NEAR(own(scene, "A"), omega + (1 - omega) * kPi, 1e-12);
}

TEST(Diagnosis, InALoopFallsToTheFirstOnset) {
  Scene scene = chain();
  scene.link("c", "a").fail("A", 400ms).fail("B").fail("C", 200ms);  // a cycle is 200 ms
  const double sum = 1.0 / 3 + 1 + 1.0 / 2;
  const double omega = 1 / sum;
  EXPECT_NEAR(own(scene, "B"), omega + (1 - omega) * kPi, 1e-12);
}

TEST(Diagnosis, InALoopAFlappingFailureBeganWhenItWasFirstThere) {
  Scene scene = chain();
  scene.link("c", "a").fail("A", 400ms).fail("B").fail("C", 200ms);
  scene->states.state(scene.rule("A")).first_onset = Time(50s);
  EXPECT_GT(own(scene, "A"), own(scene, "B"));
}

TEST(Diagnosis, OfALoopIsExplainedByACauseUpstreamOfIt) {
  Scene scene = chain();
  scene.link("c", "b").fail("A").fail("B").fail("C");
  const double half = 0.5 + 0.5 * kPi;
  EXPECT_DOUBLE_EQ(own(scene, "A"), 1);
  EXPECT_NEAR(own(scene, "B"), own_cause(kPi, kKappa) * half, 1e-12);
}

TEST(Diagnosis, SharesTheExplainedPart) {
  Scene scene = chain();
  scene.fail("A").fail("B").fail("C");
  const Examination found(*scene, scene->states.active());
  const Diagnosis& r = found.diagnosis();
  EXPECT_NEAR(r.share(0, 2) + r.share(1, 2), 1 - r.of(2), 1e-12);
  EXPECT_NEAR(r.share(0, 2) / r.share(1, 2), r.of(0) / r.of(1), 1e-9);
  EXPECT_EQ(r.share(2, 0), 0);
}

// A supplier needs no rule: a consumer of one in trouble is an effect.
TEST(Diagnosis, ASupplierCountsWithoutARule) {
  Scene scene("COMPONENT a NODE /a\n" + failure_of("b", "B"));
  scene.link("a", "b").fail("B");
  EXPECT_DOUBLE_EQ(own(scene, "B"), 1);
  const ComponentId a = scene.component("a");
  scene.process("a", ProcessState::kGone);
  EXPECT_LT(own(scene, "B"), 0.5) << "it exited";
  scene.process("a", ProcessState::kStopped);
  EXPECT_LT(own(scene, "B"), 0.5) << "it is stopped";
  scene.process("a", ProcessState::kRunning);
  scene->components[a].in_graph = true;
  scene->components[a].alive = false;
  EXPECT_LT(own(scene, "B"), 0.5) << "it hangs";
  scene->components[a].alive = true;
  scene->components[a].lifecycle = Lifecycle::kInactive;
  scene->components[a].was_active = true;
  EXPECT_LT(own(scene, "B"), 0.5) << "it is not active any more";
  scene->components[a].was_active = false;
  scene->states.state(scene.rule("B")).detection.last_false = Time(50s);
  EXPECT_DOUBLE_EQ(own(scene, "B"), 1) << "it worked without";
  scene->components[a].lifecycle = Lifecycle::kActive;
  EXPECT_DOUBLE_EQ(own(scene, "B"), 1);
}

// A process that hangs may wait for an answer. If no rule repairs the supplier, the hang counts as its own in the end, once.
TEST(Diagnosis, AHangThatLastsIsItsOwnAlthoughASupplierIsDown) {
  const auto own_after = [](const std::string& supplier, Duration time, int attempts) {
    Scene scene(supplier + failure_of("b", "B"));
    scene.link("a", "b").fail("B");
    scene.process("a", ProcessState::kGone);
    ComponentState& b = scene->components[scene.component("b")];
    b.in_graph = true;
    b.alive = false;
    RuleState& state = scene->states.state(scene.rule("B"));
    state.search.attempts = attempts;
    scene->now = later(state.failing_since, time);
    return own(scene, "B");
  };
  const std::string unwatched = "COMPONENT a NODE /a\n";
  EXPECT_LT(own_after(unwatched, kLongestWaitForAnswer - 1s, 0), 0.5);
  EXPECT_GT(own_after(unwatched, kLongestWaitForAnswer, 0), 0.5);
  EXPECT_LT(own_after(unwatched, kLongestWaitForAnswer, 1), 0.5) << "that was tried in vain";
  EXPECT_LT(own_after(failure_of("a", "A"), 1h, 0), 0.5) << "a rule repairs the supplier";
}

std::string about_states(const std::string& trigger, const std::string& adaptations) {
  return "COMPONENT b NODE /b\nRULE B\nPOLICIES ERROR\nTRIGGER " + trigger +
         "\nSTRATEGY cure 50 10\n" + adaptations;
}

// Its supplier is not active, which is just what the rule is about. A rule that only looks while its
// component is active is about something else.
TEST(Diagnosis, ALifecycleExplainsNoRuleAboutStates) {
  const std::string sets = "ADAPTATION b set_parameter gain 1 2\n";
  const std::string changes = "ADAPTATION b change_mode slow 2\n";
  const auto own_of = [](const std::string& rule, Lifecycle of_b = Lifecycle::kActive) {
    Scene scene("COMPONENT a NODE /a\n" + rule);
    ComponentState& a = scene->components[scene.component("a")];
    a.lifecycle = Lifecycle::kInactive;
    a.was_active = true;
    scene->components[scene.component("b")].lifecycle = of_b;
    scene.link("a", "b").fail("B");
    return own(scene, "B");
  };
  EXPECT_LT(own_of(about_states("x > 1", sets)), 0.5);
  EXPECT_DOUBLE_EQ(own_of(about_states("x > 1", sets + changes)), 1);
  EXPECT_DOUBLE_EQ(
      own_of(about_states("x > 1 || lifecycle(b) != \"active\"", sets), Lifecycle::kInactive), 1);
  EXPECT_LT(own_of(about_states("x > 1 && lifecycle(b) == \"active\"", sets)), 0.5);
}

// A failure that strategies only reconfigure is no cause of worse ones.
TEST(Diagnosis, ALesserFailureIsACauseIfAnyOfItsStrategiesBeginsAnew) {
  const std::string tuned =
      "COMPONENT a NODE /a\nCOMPONENT aside NODE /aside\nRULE A\nPOLICIES WARNING\nTRIGGER y > "
      "1\nSTRATEGY tune 50 10\nADAPTATION a set_parameter gain 1 2\n";
  const std::string anew =
      "STRATEGY anew 50 10\nADAPTATION aside set_parameter gain 1 2\nADAPTATION a restart 2\n";
  const auto own_of = [](const std::string& rules) {
    Scene scene(rules + failure_of("b", "B"));
    scene.link("a", "b").fail("A").fail("B");
    return own(scene, "B");
  };
  EXPECT_DOUBLE_EQ(own_of(tuned), 1);
  EXPECT_LT(own_of(tuned + anew), 0.5);
}

// Its strategy was refused: the robot does not slow down, and that silences nothing.
TEST(Diagnosis, AMissionIsNoCause) {
  const auto own_of = [](const std::string& policies) {
    Scene scene("COMPONENT a NODE /a\nRULE A\nPOLICIES " + policies +
                "\nTRIGGER y > 1\nSTRATEGY slow 90 10\nADAPTATION a change_mode slow 1\n" +
                failure_of("b", "B"));
    scene.link("a", "b").exhaust("A").fail("B");
    return own(scene, "B");
  };
  EXPECT_LT(own_of("ERROR"), 0.5);
  EXPECT_DOUBLE_EQ(own_of("ERROR ON_CHANGE"), 1);
}

// Its strategy does more than to start it again.
TEST(Diagnosis, RisesAlsoWhereAStrategyDoesMoreThanToReplaceTheProcess) {
  Scene scene(failure_of("a", "A") +
              "COMPONENT b NODE /b LAUNCH \"b\"\nRULE B\nPOLICIES ERROR\nTRIGGER y > 1\nSTRATEGY "
              "anew 50 10\nADAPTATION b redeploy 2\nADAPTATION a set_parameter gain 1 2\n");
  scene.link("a", "b").fail("A").fail("B");
  EXPECT_LT(own(scene, "B"), 0.5);
  scene.process("b", ProcessState::kGone);
  EXPECT_GT(own(scene, "B"), 0.5);
}

// It worked for ten minutes in spite of the trouble, so the trouble is not why.
TEST(Diagnosis, AnOldTroubleExplainsNothingNew) {
  Scene scene("COMPONENT a NODE /a\n" + failure_of("b", "B"));
  scene.link("a", "b");
  scene->now = Time(1000s);
  scene->components[scene.component("a")].lifecycle = Lifecycle::kInactive;
  scene->components[scene.component("a")].was_active = true;
  scene->components[scene.component("a")].lifecycle_since = Time(100s);
  scene->states.state(scene.rule("B")).onset = Onset{Time(900s), Time(900s)};
  scene->states.state(scene.rule("B")).worked_until = Time(900s);
  scene.fail("B");
  EXPECT_GT(own(scene, "B"), 0.5);
  scene->states.state(scene.rule("B")).worked_until = Time(102s);
  EXPECT_LT(own(scene, "B"), 0.5);
}

TEST(Diagnosis, ACauseBeginsBeforeItsEffect) {
  Scene scene = chain();
  scene.fail("A").fail("B");
  scene->states.state(scene.rule("A")).onset = Onset{Time(88s), Time(89s)};
  scene->states.state(scene.rule("B")).onset = Onset{Time(85s), Time(86s)};
  EXPECT_DOUBLE_EQ(own(scene, "B"), 1);
  scene->states.state(scene.rule("B")).onset = Onset{Time(88s), Time(90s)};
  EXPECT_LT(own(scene, "B"), 0.5);
}

TEST(Diagnosis, ACouplingThatWasLearnedNeedsNoEdge) {
  Scene scene(failure_of("a", "A") + failure_of("b", "B"));
  scene.fail("A").fail("B");
  EXPECT_DOUBLE_EQ(own(scene, "B"), 1);
  scene->couplings.set(scene.rule("A"), scene.rule("B"), {1, 9});
  EXPECT_DOUBLE_EQ(own(scene, "B"), 1) << "it seldom passes anything on";
  scene->couplings.set(scene.rule("A"), scene.rule("B"), {2, 0});
  EXPECT_LT(own(scene, "B"), 0.5);
  EXPECT_DOUBLE_EQ(own(scene, "A"), 1);
}

// It has never worked, and no node offers what it reads: it waits for its supplier.
TEST(Diagnosis, AnInputWithoutASupplierExplainsAFunctionThatNeverWorked) {
  Scene scene(failure_of("b", "B"));
  scene->graph.endpoint_appeared("/b", EndpointKind::kClient, "/map");
  scene.fail("B");
  EXPECT_LT(own(scene, "B"), 0.5);
  scene->states.state(scene.rule("B")).detection.last_false = Time(50s);
  EXPECT_DOUBLE_EQ(own(scene, "B"), 1) << "it worked without it";
}

// It is deactivated only while the driver is replaced. Without that, it is itself what is repaired.
TEST(Diagnosis, AFailureIsNotWhereAStrategyOnlyPauses) {
  const auto own_of = [](const std::string& between) {
    Scene scene(failure_of("ctl", "Ctl") +
                "COMPONENT driver NODE /driver LAUNCH \"driver\"\nCOMPONENT planner NODE /planner\n"
                "RULE Driver\nPOLICIES ERROR\nTRIGGER y > 1\nSTRATEGY safe 80 10\n"
                "ADAPTATION planner deactivate 2\n" +
                between + "THEN ADAPTATION planner activate 2\n");
    scene.link("driver", "ctl").link("ctl", "planner").fail("Ctl").fail("Driver");
    return own(scene, "Driver");
  };
  EXPECT_DOUBLE_EQ(own_of("THEN ADAPTATION driver redeploy 10\n"), 1);
  EXPECT_LT(own_of(""), 0.5);
}

// It is dark, so a lamp is switched on: the camera's value is bad, and what needs the camera doubts. A rule that
// reads it beside a value of what it repairs is about the latter; and bad data ends no data.
TEST(Diagnosis, ABadValueThatIsMendedElsewhereSpreadsFromItsPublisher) {
  const auto own_of = [](const std::string& dark, const std::string& lamp,
                         const std::string& of_b) {
    std::string consumer = failure_of("b", "B");
    consumer.replace(consumer.find("x > 1"), 5, of_b);
    Scene scene(
        "COMPONENT camera NODE /camera\nCOMPONENT lamp NODE /lamp\n"
        "SIGNAL dark DIAGNOSTIC camera KEY dark\nSIGNAL heat DIAGNOSTIC lamp KEY heat\n"
        "RULE Dark\nPOLICIES ERROR\nTRIGGER " +
        dark + "\nSTRATEGY light 90 10\nADAPTATION lamp " + lamp + " 10\n" + consumer);
    scene.link("camera", "b").fail("Dark").fail("B");
    return own(scene, "B");
  };
  EXPECT_DOUBLE_EQ(own_of("dark > 1", "call ~/on", "x > 1"), own_cause(kPi, kKappa));
  EXPECT_DOUBLE_EQ(own_of("dark > 1 && heat < 9", "call ~/on", "x > 1"), 1);
  EXPECT_DOUBLE_EQ(own_of("dark > 1", "set_parameter on true", "x > 1"), 1);
  EXPECT_DOUBLE_EQ(own_of("dark > 1", "call ~/on", "age(/t) > 3s"), 1);
}

// A safe stop adapts a component that has nothing to do with the failure.
TEST(Diagnosis, ALastResortTouchesNothing) {
  Scene scene(failure_of("a", "A") + failure_of("b", "B") +
              "STRATEGY stop 100 10 LASTRESORT\nADAPTATION a set_parameter speed 0 1\n");
  scene.fail("A").fail("B");
  EXPECT_DOUBLE_EQ(own(scene, "B"), 1);
  EXPECT_DOUBLE_EQ(own(scene, "A"), 1);
}

}  // namespace
}  // namespace culprit::diagnose
