#include "plan/bayes/bayes_planner.h"

#include <gtest/gtest.h>

#include "knowledge/describe.h"
#include "plan/bayes/test_scene.h"
#include "plan/paper_planner.h"

namespace culprit {
namespace {

using namespace std::chrono_literals;
using plan::failure_of;
using plan::Scene;

const BayesPlanner kBalanced;
const BayesPlanner kFewRedeployments(Objective::kRedeployments);
const BayesPlanner kFewAdaptations(Objective::kAdaptations);

// a -> b -> c, and d beside them.
Scene robot() {
  Scene scene(failure_of("a", "A") + failure_of("b", "B") + failure_of("c", "C") +
              failure_of("d", "D"));
  scene.link("a", "b").link("b", "c");
  return scene;
}

TEST(BayesPlanner, ActsOnTheRootCauseOnly) {
  Scene scene = robot();
  scene.fail("A").fail("B").fail("C");
  EXPECT_EQ(scene.plan(kFewRedeployments), "A.restart");
  EXPECT_EQ(scene.candidate("B.restart").excluded, Condition::kDependency);
  EXPECT_EQ(scene.candidate("B.restart").failure, scene.rule("A"));
}

TEST(BayesPlanner, ActsOnIndependentFailuresAtOnce) {
  Scene scene = robot();
  scene.fail("A").fail("B").fail("D");
  EXPECT_EQ(scene.plan(kFewRedeployments), "A.restart D.restart");
}

TEST(BayesPlanner, AFailureDoesNotGoThroughAComponentThatIsSeenToBeWell) {
  Scene scene = robot();
  scene.fail("A").fail("C");
  scene.plan(kFewRedeployments);
  EXPECT_EQ(scene.candidate("C.restart").excluded, Condition::kDependency) << "b may be ill";
  scene.see_working("B");
  scene.plan(kFewRedeployments);
  EXPECT_NE(scene.candidate("C.restart").excluded, Condition::kDependency);
}

TEST(BayesPlanner, BreaksACircleThatThePaperWaitsInForEver) {
  Scene scene = robot();
  scene.link("c", "a").fail("A").fail("B").fail("C");
  EXPECT_EQ(scene.plan(PaperPlanner()), "");
  EXPECT_EQ(scene.plan(kFewRedeployments), "A.restart") << "one of equals: the first by name";
  scene.tried("A.restart");
  EXPECT_EQ(scene.plan(kFewRedeployments), "B.restart") << "less is left to try at A";
}

TEST(BayesPlanner, FollowsTheObjective) {
  Scene scene = robot();
  scene.fail("A");
  EXPECT_EQ(scene.plan(kFewRedeployments), "A.restart");
  EXPECT_EQ(scene.plan(kFewAdaptations), "A.redeploy") << "90 % beats 50 % where each counts one";
}

TEST(BayesPlanner, CountsWhatARedeployAlsoEnds) {
  Scene scene = robot();
  scene.fail("A").tried("A.restart");
  scene.plan(kBalanced);
  const double alone = scene.candidate("A.redeploy").cost;
  scene->components[scene.component("a")].ends_with = {scene.component("d")};
  EXPECT_EQ(scene.plan(kBalanced), "A.redeploy");
  EXPECT_GT(scene.candidate("A.redeploy").cost, alone);
}

TEST(BayesPlanner, EndsNothingBesidesThatIsBeingAdapted) {
  Scene scene = robot();
  scene->components[scene.component("a")].ends_with = {scene.component("d")};
  scene.fail("A").fail("D").attempt("D.restart").tried("A.restart");
  EXPECT_EQ(scene.plan(kBalanced), "");
  EXPECT_EQ(scene.candidate("A.redeploy").excluded, Condition::kAdapting);
  EXPECT_EQ(scene.candidate("A.redeploy").component, scene.component("d"));
  Scene other = robot();
  other->components[other.component("a")].ends_with = {other.component("d")};
  other.fail("A").fail("D");
  EXPECT_EQ(other.plan(kFewRedeployments), "A.restart D.restart") << "a restart ends no process";
}

TEST(BayesPlanner, WaitsLikeAnyOtherIfTheDeadCouldOnlyComeBackWithTheLiving) {
  Scene scene = robot();
  scene.fail("A").fail("D").attempt("D.restart").process("a", ProcessState::kGone);
  scene->components[scene.component("a")].ends_with = {scene.component("d")};
  EXPECT_EQ(scene.plan(kBalanced), "");
}

TEST(BayesPlanner, TriesWhatIsLeft) {
  Scene scene = robot();
  scene.fail("A").tried("A.restart");
  EXPECT_EQ(scene.plan(kFewRedeployments), "A.redeploy");
  scene.tried("A.redeploy");
  EXPECT_EQ(scene.plan(kFewRedeployments), "");
  EXPECT_TRUE(scene.decision("A").is_spent);
}

TEST(BayesPlanner, ReplacesAProcessThatIsGone) {
  Scene scene = robot();
  scene.fail("A");
  scene.process("a", ProcessState::kGone);
  EXPECT_EQ(scene.plan(kFewRedeployments), "A.redeploy");
  EXPECT_EQ(scene.candidate("A.restart").excluded, Condition::kInvalid);
}

TEST(BayesPlanner, ActsOnAComponentWhoseProcessIsGoneThoughOthersMayExplainIt) {
  Scene scene = robot();
  scene.fail("A").fail("B");
  scene.process("b", ProcessState::kGone);
  scene->states.state(scene.rule("A")).search.retry_at = kNever;  // it is in its back-off
  scene.plan(kFewRedeployments);
  EXPECT_NE(scene.candidate("B.redeploy").excluded, Condition::kDependency);
}

TEST(BayesPlanner, LeavesAloneWhatIsBeingAdaptedAndWhatDependsOnIt) {
  Scene scene = robot();
  scene.attempt("A.restart").fail("C").fail("D");
  scene->couplings.set(scene.rule("A"), scene.rule("C"), {0, 1000});  // it is a failure of its own
  EXPECT_EQ(scene.plan(kFewRedeployments), "D.restart");
  EXPECT_EQ(scene.candidate("C.restart").excluded, Condition::kDownstream);
  EXPECT_EQ(scene.candidate("C.restart").component, scene.component("a"));
}

TEST(BayesPlanner, WaitsWhileAnUpstreamComponentIsSuspect) {
  std::string text = failure_of("a", "A") + failure_of("b", "B");
  text.replace(text.find("x > 1"), 5, "age(/out) > 2s");
  Scene scene(text);
  scene.link("a", "b").fail("B", 9900ms);  // 100 ms ago
  scene->signals.set_rhythm(TopicId(0), {scene->now - 450ms, 100ms, 100ms});
  EXPECT_EQ(scene.plan(kFewRedeployments), "");
  EXPECT_EQ(scene.candidate("B.restart").excluded, Condition::kSuspect);
  EXPECT_EQ(scene.candidate("B.restart").failure, scene.rule("A"));
  EXPECT_FALSE(scene.decision("B").is_spent);
  scene->signals.set_rhythm(TopicId(0), {scene->now - 50ms, 100ms, 100ms});
  EXPECT_EQ(scene.plan(kFewRedeployments), "B.restart") << "it spoke";
  scene->signals.set_rhythm(TopicId(0), {scene->now - 1500ms, 100ms, 100ms});
  scene->now += 400ms;
  EXPECT_EQ(scene.plan(kFewRedeployments), "")
      << "19 missed messages are plain before the rule fires";
}

TEST(BayesPlanner, WaitsForAMonitorUpstreamUntilItWouldHaveShownTheCause) {
  std::string text = failure_of("a", "A") + failure_of("b", "B");
  text.replace(text.rfind("x > 1"), 5, "y > 1");
  Scene scene(text);
  scene.link("a", "b").fail("B", 9900ms);  // 100 ms ago
  scene->latencies.weigh(-3);              // monitors are as quick as the rules state
  scene->states.state(scene.rule("A")).detection.trigger = Slot::of(false);
  const auto reads = [&](Duration interval) {
    scene->signals.set_latency(scene.rules()[scene.rule("A")].inputs.front(), 2 * interval);
  };
  reads(200ms);
  EXPECT_EQ(scene.plan(kFewRedeployments), "");
  EXPECT_EQ(scene.candidate("B.restart").excluded, Condition::kSuspect);
  scene->now += 400ms;
  EXPECT_EQ(scene.plan(kFewRedeployments), "B.restart") << "it was read, and is well";
  reads(700ms);
  EXPECT_EQ(scene.plan(kFewRedeployments), "") << "its next reading is still to come";
}

TEST(BayesPlanner, GivesAFailureTimeToSettleAfterItsCauseIsGone) {
  Scene scene = robot();
  scene.fail("B");
  scene->states.state(scene.rule("B")).settling =
      Settling{scene.rule("A"), scene->now, scene->now + 500ms};
  EXPECT_EQ(scene.plan(kFewRedeployments), "");
  EXPECT_EQ(scene.candidate("B.restart").excluded, Condition::kSettling);
  scene->couplings.set(scene.rule("A"), scene.rule("B"), {0, 1.8});
  EXPECT_EQ(scene.plan(kFewRedeployments), "B.restart") << "as likely as not";
  scene->couplings.set(scene.rule("A"), scene.rule("B"), {0, 10});
  EXPECT_EQ(scene.plan(kFewRedeployments), "B.restart") << "they never went away together";
  scene->couplings.set(scene.rule("A"), scene.rule("B"), {});
  scene->now += 500ms;
  EXPECT_EQ(scene.plan(kFewRedeployments), "B.restart");
}

TEST(BayesPlanner, LetsALesserFailureNeverDelayAGreaterOne) {
  Scene scene(failure_of("a", "Focus", "NON_CRITICAL") + failure_of("b", "Dead"));
  scene.link("a", "b").fail("Focus").fail("Dead");
  scene->couplings.set(scene.rule("Focus"), scene.rule("Dead"), {0, 1000});  // it explains nothing
  EXPECT_EQ(scene.plan(kFewRedeployments), "Dead.restart");
  EXPECT_EQ(scene.candidate("Focus.restart").excluded, Condition::kInTheWay);
}

// A known-dead camera and its effects, each worse than the one before.
TEST(BayesPlanner, TreatsACauseAsTheWorstFailureThatItExplains) {
  Scene scene(failure_of("a", "Camera", "NON_CRITICAL") + failure_of("b", "Blind", "WARNING") +
              failure_of("c", "Lost") + failure_of("d", "Other"));
  scene.link("a", "b").link("b", "c").fail("Camera").fail("Blind").fail("Lost").fail("Other");
  EXPECT_EQ(scene.plan(kFewRedeployments), "Camera.restart Other.restart");
  EXPECT_EQ(scene.decisions().front().rule, scene.rule("Camera")) << "and first: it explains more";
  EXPECT_EQ(scene.candidate("Lost.restart").excluded, Condition::kDependency);
  EXPECT_EQ(scene.candidate("Lost.restart").failure, scene.rule("Camera"));
}

TEST(BayesPlanner, WaitsForALesserCauseThatIsKnownToBeDead) {
  std::string text = failure_of("a", "Camera", "WARNING FOR 3s") + failure_of("b", "Blind");
  text.replace(text.find("x > 1"), 5, "!alive(a)");
  Scene scene(text);
  scene.link("a", "b").fail("Blind", 9900ms);  // 100 ms ago
  scene.process("a", ProcessState::kGone);
  EXPECT_EQ(scene.plan(kFewRedeployments), "");
  EXPECT_EQ(scene.candidate("Blind.restart").excluded, Condition::kDependency);
  EXPECT_EQ(scene.candidate("Blind.restart").component, scene.component("a"));
  scene->now += 1min;
  EXPECT_EQ(scene.plan(kFewRedeployments), "") << "a consumer of a dead component is not repaired";
}

TEST(BayesPlanner, ReplacesTheDeadSideBySide) {
  Scene scene = robot();
  scene.fail("A").fail("B").fail("C");
  scene.process("a", ProcessState::kGone);
  scene.process("c", ProcessState::kStopped);
  EXPECT_EQ(scene.plan(kFewRedeployments), "A.redeploy C.redeploy");
  EXPECT_EQ(scene.candidate("B.restart").excluded, Condition::kDependency);
}

TEST(BayesPlanner, ReplacesTheDeadDownstreamOfWhatIsBeingAdapted) {
  Scene scene = robot();
  scene.attempt("A.restart").fail("B").fail("C");
  scene.process("c", ProcessState::kGone);
  EXPECT_EQ(scene.plan(kFewRedeployments), "C.redeploy");
}

TEST(BayesPlanner, ExpectsNothingDeadToGoAwayByItself) {
  Scene scene = robot();
  scene.fail("B");
  scene.process("b", ProcessState::kGone);
  scene->states.state(scene.rule("B")).settling =
      Settling{scene.rule("A"), scene->now, scene->now + 500ms};
  EXPECT_EQ(scene.plan(kFewRedeployments), "B.redeploy");
}

TEST(BayesPlanner, LetsAGreaterFailureActWhileALesserOneUpstreamIsJudged) {
  Scene scene(failure_of("a", "Focus", "NON_CRITICAL") + failure_of("b", "Dead"));
  scene.link("a", "b").attempt("Focus.restart", Attempt::Stage::kWaiting).fail("Dead");
  scene->couplings.set(scene.rule("Focus"), scene.rule("Dead"), {0, 1000});
  EXPECT_EQ(scene.plan(kFewRedeployments), "Dead.restart");
}

TEST(BayesPlanner, LetsAGreaterFailureHaveTheComponentOfALesserOneThatIsJudged) {
  Scene scene(failure_of("a", "Focus", "NON_CRITICAL") + "RULE Dead\nPOLICIES ERROR\n" +
              "TRIGGER x > 1\nSTRATEGY restart 50 10\nADAPTATION a restart 2\n");
  scene.fail("Dead").attempt("Focus.restart");
  EXPECT_EQ(scene.plan(kFewRedeployments), "");
  EXPECT_EQ(scene.candidate("Dead.restart").excluded, Condition::kAdapting);
  scene.attempt("Focus.restart", Attempt::Stage::kWaiting);
  EXPECT_EQ(scene.plan(kFewRedeployments), "Dead.restart");
}

TEST(BayesPlanner, DoesWhatIsSureAtOnceWhileAGreaterFailureDownstreamWaits) {
  const auto focus = [](const char* chance) {
    return "COMPONENT a NODE /a\nRULE Focus\nPOLICIES NON_CRITICAL\nTRIGGER x > 1\nSTRATEGY set " +
           std::string(chance) + " 10\nADAPTATION a set_parameter p 1 2\n";
  };
  std::string suspect = failure_of("b", "B");
  suspect.replace(suspect.find("x > 1"), 5, "age(/out) > 2s");
  for (const bool is_sure : {true, false}) {
    Scene scene(focus(is_sure ? "95" : "60") + suspect + failure_of("c", "C", "WARNING"));
    scene.link("a", "c").link("b", "c").fail("Focus", 9900ms).fail("C", 9900ms);  // 100 ms ago
    scene->signals.set_rhythm(TopicId(0), {scene->now - 450ms, 100ms, 100ms});
    scene->couplings.set(scene.rule("Focus"), scene.rule("C"), {0, 1000});
    EXPECT_EQ(scene.plan(kBalanced), is_sure ? "Focus.set" : "");
    EXPECT_EQ(scene.candidate("C.restart").excluded, Condition::kSuspect);
  }
}

TEST(BayesPlanner, SaysWhatIsChosenInsteadAtTheSameComponent) {
  Scene scene(failure_of("c", "A") +
              "RULE B\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY tune 50 10\nADAPTATION c "
              "set_parameter p 1 9\n");
  scene.fail("A").fail("B");
  ASSERT_EQ(scene.plan(kBalanced), "A.restart");
  EXPECT_EQ(scene.candidate("B.tune").excluded, Condition::kAffected);
  EXPECT_EQ(scene.candidate("B.tune").failure, scene.rule("A"));
}

TEST(BayesPlanner, PrefersTheStrategyThatClearsMore) {
  // Two rules touch one component; nothing else tells them apart.
  Scene scene(failure_of("a", "A") + failure_of("b", "B") +
              "RULE AToo\nPOLICIES ERROR\nTRIGGER x > 1\nSTRATEGY restart 50 10\n"
              "ADAPTATION a restart 2\nSTRATEGY redeploy 90 10\nADAPTATION a redeploy 10\n");
  scene.link("a", "b").fail("A").fail("AToo").fail("B");
  scene->couplings.set(scene.rule("AToo"), scene.rule("B"), {9, 0});
  scene->couplings.set(scene.rule("A"), scene.rule("B"), {0, 9});
  EXPECT_EQ(scene.plan(kFewRedeployments), "AToo.restart");
}

// Its effect waits for a person with it, and one reconfiguration may lead round it.
TEST(BayesPlanner, RepairsNothingThatAnExhaustedFailureExplains) {
  Scene scene(failure_of("a", "A", "WARNING") + failure_of("b", "B") + failure_of("c", "C") +
              "STRATEGY other 5 10\nADAPTATION c change_communication in /other 2\n" +
              failure_of("d", "D"));
  scene.link("a", "b").link("b", "c").exhaust("A").fail("B").fail("C").fail("D");
  EXPECT_EQ(scene.plan(kFewRedeployments), "C.other D.restart");
  EXPECT_EQ(scene.candidate("B.restart").excluded, Condition::kDependency);
  EXPECT_EQ(scene.candidate("B.restart").failure, scene.rule("A"));
  EXPECT_FALSE(scene.decision("B").is_spent);
  scene.tried("C.other");
  EXPECT_EQ(scene.plan(kFewRedeployments), "D.restart") << "once";
  scene->states.state(scene.rule("A")).detection.trigger = Slot::of(false);
  EXPECT_EQ(scene.plan(kFewRedeployments), "B.restart D.restart") << "it no longer explains them";
}

// The component is that which the rule reads, wherever it is declared.
TEST(BayesPlanner, NamesTheComponentThatAReportIsAbout) {
  Scene scene(failure_of("b", "B") +
              "COMPONENT a NODE /a\nSIGNAL dirt DIAGNOSTIC a KEY dirt\n"
              "RULE Dirty\nPOLICIES ERROR REPORT\nTRIGGER dirt > 1\n");
  scene.link("a", "b").exhaust("Dirty").fail("B");
  EXPECT_EQ(scene.plan(kFewRedeployments), "");
  EXPECT_EQ(scene.candidate("B.restart").failure, scene.rule("Dirty"));
  EXPECT_EQ(scene.candidate("B.restart").component, scene.component("a"));
}

// If a process in a feedback loop is down, its component was the first to fail.
TEST(BayesPlanner, RepairsNothingInACircleThatADeadMemberExplains) {
  Scene scene(failure_of("a", "A") + failure_of("b", "B") +
              "STRATEGY other 5 10\nADAPTATION b change_communication in /other 2\n" +
              failure_of("c", "C"));
  scene.link("a", "b").link("b", "c").link("c", "a").exhaust("A").fail("B").fail("C");
  scene.process("a", ProcessState::kGone);
  EXPECT_EQ(scene.plan(kFewRedeployments), "B.other") << "it may lead round the dead one";
  EXPECT_EQ(scene.candidate("C.restart").excluded, Condition::kDependency);
  EXPECT_EQ(scene.candidate("C.restart").failure, scene.rule("A"));
  scene.tried("B.other");
  EXPECT_EQ(scene.plan(kFewRedeployments), "");
  scene.process("c", ProcessState::kGone);
  EXPECT_EQ(scene.plan(kFewRedeployments), "C.redeploy") << "it is down itself";
  scene.process("c", ProcessState::kRunning);
  scene.process("a", ProcessState::kRunning);
  EXPECT_NE(scene.plan(kFewRedeployments), "") << "nobody knows who was first: they take turns";
}

// It has a cause of its own, and so has the dead component: neither disturbs the other.
TEST(BayesPlanner, LetsALesserRootUpstreamOfTheDeadActAtOnce) {
  for (const bool is_replaced : {false, true}) {
    Scene scene(failure_of("a", "Root", "NON_CRITICAL") + failure_of("b", "Dead", "WARNING"));
    scene.link("a", "b").fail("Root");
    if (is_replaced) {
      scene.attempt("Dead.redeploy");
    } else {
      scene.fail("Dead");
    }
    scene.process("b", ProcessState::kGone);
    EXPECT_EQ(scene.plan(kFewRedeployments),
              is_replaced ? "Root.restart" : "Dead.redeploy Root.restart");
  }
}

TEST(BayesPlanner, LeavesLastResortsToTheManager) {
  Scene scene(failure_of("a", "A") + failure_of("b", "B") +
              "STRATEGY safe 99 10 LASTRESORT\nADAPTATION b set_parameter speed 0 1\n");
  scene.link("a", "b").exhaust("A").fail("B");
  EXPECT_EQ(scene.plan(kFewRedeployments), "");
  EXPECT_EQ(scene.candidate("B.restart").excluded, Condition::kDependency);
  EXPECT_EQ(scene.candidate("B.safe").excluded, Condition::kInvalid);
}

// Another source restores the function at once; the repair of the cause goes on beside it.
TEST(BayesPlanner, GoesRoundACauseWhoseRepairTakesMuchLonger) {
  const auto scene_with = [](const char* repair, const char* workaround, Duration since = 2s) {
    Scene scene(
        "COMPONENT a NODE /a LAUNCH \"a\"\nRULE A\nPOLICIES ERROR\nTRIGGER x > 1\n"
        "STRATEGY redeploy 90 10\nADAPTATION a redeploy " +
        std::string(repair) + "\n" + failure_of("b", "B") + "STRATEGY other 80 10\nADAPTATION b " +
        workaround + " 2\n");
    scene.link("a", "b").fail("A", 10s - since).fail("B", 10s - since);
    return scene;
  };
  Scene slow = scene_with("60", "change_communication in /other");
  EXPECT_EQ(slow.plan(kBalanced), "A.redeploy B.other");
  EXPECT_EQ(slow.candidate("B.restart").excluded, Condition::kDependency);
  EXPECT_EQ(scene_with("10", "change_communication in /other").plan(kBalanced), "A.redeploy");
  EXPECT_EQ(scene_with("10", "change_communication in /other", 8s).plan(kBalanced),
            "A.redeploy B.other")
      << "it has taken long already";
  EXPECT_EQ(scene_with("60", "set_parameter p 1").plan(kBalanced), "A.redeploy");
  const char* both = "set_parameter p 1 2\nADAPTATION b change_communication in /other";
  EXPECT_EQ(scene_with("60", both).plan(kBalanced), "A.redeploy") << "it does more than that";
}

TEST(BayesPlanner, StaggersTheRepairsOfFailuresThatRepeatedlyBeginTogether) {
  Scene scene = robot();
  scene.fail("A").fail("D");
  ASSERT_EQ(scene.plan(kFewRedeployments), "A.restart D.restart");
  const auto begin_together = [&] {
    scene->coincidences.began(scene.rule("A"), {});
    scene->coincidences.began(scene.rule("D"), std::vector<RuleId>{scene.rule("A")});
  };
  begin_together();
  EXPECT_EQ(scene.plan(kFewRedeployments), "A.restart D.restart") << "once may be chance";
  begin_together();
  EXPECT_EQ(scene.plan(kFewRedeployments), "A.restart");
  EXPECT_EQ(scene.candidate("D.restart").excluded, Condition::kInTheWay);
  EXPECT_EQ(scene.candidate("D.restart").failure, scene.rule("A"));
  begin_together();
  EXPECT_EQ(scene.plan(kFewRedeployments), "D.restart") << "the other one, the next time";
  scene->states.state(scene.rule("D")).search.attempts = 1;
  EXPECT_EQ(scene.plan(kFewRedeployments), "A.restart") << "it did not help";
}

// The effect waits for its cause; if the cause gave way to it as well, both would wait for ever.
TEST(BayesPlanner, NoFailureGivesWayToAnEffect) {
  Scene scene = robot();
  scene.fail("A").fail("B").fail("D");
  for (int i = 0; i < 2; ++i) {
    scene->coincidences.began(scene.rule("B"), {});
    scene->coincidences.began(scene.rule("D"), std::vector<RuleId>{scene.rule("B")});
    scene->coincidences.began(scene.rule("A"), std::vector<RuleId>{scene.rule("B")});
  }
  EXPECT_EQ(scene.plan(kFewRedeployments), "A.restart D.restart");
}

TEST(BayesPlanner, SaysTheSuspectAndItsValue) {
  Scene scene = robot();
  scene.fail("A").fail("B");
  scene.plan(kBalanced);
  const auto& suspects = scene.decision("B").suspects;
  ASSERT_EQ(suspects.size(), 2u);
  EXPECT_EQ(suspects[0].component, scene.component("a"));
  EXPECT_EQ(suspects[0].failure, scene.rule("A"));
  EXPECT_NEAR(suspects[0].probability + suspects[1].probability, 1, 1e-12);
  EXPECT_GT(suspects[0].probability, 0.9);
  EXPECT_EQ(suspects[0].evidence[0].without, "b") << "if A did not fire";
  EXPECT_GT(scene.candidate("A.restart").value, 4) << "an ERROR, and a share of another";
  EXPECT_DOUBLE_EQ(scene.candidate("A.restart").resolves, 0.5);
}

TEST(BayesPlanner, LeavesAFailureAloneForAsLongAsSuchFailuresTookToClear) {
  Scene scene = robot();
  scene->transients.add(scene.rule("A"), {8, 0, 4s});
  scene.fail("A", 6s);  // 4 s ago
  EXPECT_EQ(scene.plan(kBalanced), "");
  EXPECT_EQ(scene.candidate("A.restart").excluded, Condition::kSettling);
  EXPECT_EQ(describe_exclusion(scene.candidate("A.restart"), scene.rules()),
            "such failures often clear by themselves");
  EXPECT_EQ(describe_end_of_wait(scene.candidate("A.restart"), scene.rules()),
            "if A still fails after 1.00 s, a is held responsible");
  scene.fail("A", 4s);  // 6 s ago
  EXPECT_EQ(scene.plan(kBalanced), "A.restart");
}

// It may wait for an answer of a, which no rule repairs.
TEST(BayesPlanner, SaysHowLongAHangWaitsForItsSupplier) {
  Scene scene("COMPONENT a NODE /a\n" + failure_of("b", "B"));
  scene.link("a", "b").fail("B");  // 10 s ago
  scene.process("a", ProcessState::kGone);
  ComponentState& b = scene->components[scene.component("b")];
  b.in_graph = true;
  b.alive = false;
  EXPECT_EQ(scene.plan(kBalanced), "");
  EXPECT_EQ(describe_end_of_wait(scene.candidate("B.redeploy"), scene.rules()),
            "if a is not back within 50.00 s, b is held responsible");
  scene->now += 50s;
  EXPECT_NE(scene.plan(kBalanced), "");
}

TEST(BayesPlanner, LeavesNoFailureAloneThatIsProvenOrRarelyClearsOrComesBack) {
  Scene scene = robot();
  const auto plan_anew = [&] {
    scene.fail("A", 10s);
    return scene.plan(kBalanced);
  };
  scene->transients.add(scene.rule("A"), {8, 0, 4s});
  scene->components[scene.component("a")].alive = false;
  EXPECT_NE(plan_anew(), "") << "it hangs";
  scene->components[scene.component("a")].alive = true;
  EXPECT_EQ(plan_anew(), "");
  scene->states.state(scene.rule("A")).search.times = 3;
  EXPECT_EQ(plan_anew(), "A.restart");
  scene->states.state(scene.rule("A")).search.times = 1;
  scene->transients.add(scene.rule("A"), {0, 100, {}});
  EXPECT_EQ(plan_anew(), "A.restart");
}

TEST(BayesPlanner, DecidesAboutEveryFailure) {
  Scene scene = robot();
  scene.fail("A").fail("B").fail("C").fail("D");
  scene.plan(kBalanced);
  EXPECT_EQ(scene.decisions().size(), 4u);
  EXPECT_EQ(scene.decision("C").candidates.size(), 2u);
}

}  // namespace
}  // namespace culprit
