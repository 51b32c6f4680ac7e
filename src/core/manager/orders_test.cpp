// Orders of people to the manager, and their results.
#include <gtest/gtest.h>

#include "manager/runtime.h"
#include "manager/test_robot.h"

namespace culprit::test {
namespace {

constexpr const char* kRules = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT lamp   NODE /lamp
RULE CameraDead
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms
    STRATEGY restart 90 10
      ADAPTATION camera restart 2
    STRATEGY redeploy 50 10
      ADAPTATION camera redeploy 10
RULE Dark
  POLICIES WARNING
  TRIGGER brightness < 0.5
    STRATEGY light 90 10
      ADAPTATION lamp set_parameter on 1 2
)";
constexpr RuleId kCameraDead(0);
constexpr RuleId kDark(1);
constexpr ComponentId kCamera(0);
constexpr StrategyId kRestart(0);
constexpr StrategyId kRedeploy(1);
constexpr StrategyId kLight(2);

TestRobot robot(Approval approval = Approval::kNone) {
  Manager::Options options;
  options.governor.approval = approval;
  TestRobot robot(kRules, std::make_unique<BayesPlanner>(), options);
  robot.add("camera", {}, "/rgb");
  robot.add("lamp").parameters["on"] = Value(std::int64_t{0});
  robot.discover();
  robot.signal("brightness", Value(1.0), 1s);
  return robot;
}

template <class What>
Order order(What what, std::string reason = "") {
  return {7, "Ann", std::move(reason), std::move(what)};
}

void begin_restart(TestRobot& robot) {
  robot["camera"].fault = "restart";
  for (int ms = 0; ms < 1000 && !robot.was_asked("camera: deactivate"); ++ms) robot.run_for(1ms);
  ASSERT_TRUE(robot.was_asked("camera: deactivate"));
}

TEST(Orders, PauseStopsAtOnceWhatIsUnderWayAndResumeGoesOn) {
  TestRobot r = robot();
  begin_restart(r);
  r.order(order(Pause{}, "people on the floor"));
  const std::size_t asked = r.asked.size();
  r.run_for(20s);
  EXPECT_EQ(r.asked.size(), asked);
  EXPECT_EQ(r.count("CameraDead.restart is abandoned: paused by Ann"), 1u);
  EXPECT_EQ(r.count("is held back: paused by a person"), 1u) << "said once";
  r.order(order(Resume{}), 10s);
  EXPECT_TRUE(r.works("camera"));
}

// The diagnosis does not stop with the pause.
TEST(Orders, APauseHidesNoEvidence) {
  TestRobot r = robot();
  r.order(order(Pause{}));
  r.fail("camera", "restart", 5s);
  const auto held = std::ranges::find_if(r.events, [](const Event& event) {
    return std::holds_alternative<ActionHeldBack>(event.what);
  });
  ASSERT_NE(held, r.events.end());
  const auto& told = std::get<ActionHeldBack>(held->what);
  EXPECT_EQ(told.restraint, Restraint::kPaused);
  EXPECT_FALSE(told.candidates.empty());
  ASSERT_FALSE(told.suspects.empty());
  EXPECT_EQ(told.suspects[0].component, r.id("camera"));
  EXPECT_FALSE(told.suspects[0].evidence.empty());
}

// The restart has deactivated the camera, and the pause keeps it from being activated again. The next culprit knows
// that no person deactivated it.
TEST(Orders, WhatAPausedRestartLeftInactiveIsOwedByTheNextCulprit) {
  TestRobot r = robot();
  begin_restart(r);
  r.order(order(Pause{}), 2s);
  ASSERT_EQ(r["camera"].state, Lifecycle::kInactive);
  Manager::Options options;
  options.start = r.now;
  auto next = std::make_unique<Manager>(r.rules(), std::make_unique<BayesPlanner>(), options);
  next->remember(r.events);
  EXPECT_TRUE(next->knowledge().components[kCamera].is_to_be_given_back());
}

// The camera refuses to be activated again: that is no wish of a person either.
TEST(Orders, WhatAFailedRestartLeftInactiveIsOwedByTheNextCulprit) {
  TestRobot r = robot();
  begin_restart(r);
  for (int ms = 0; ms < 1000 && r["camera"].state != Lifecycle::kInactive; ++ms) r.run_for(1ms);
  r["camera"].refuses = true;
  const auto has_failed = [&] {
    return std::ranges::any_of(r.events, [](const Event& event) {
      return std::holds_alternative<StrategyFailed>(event.what);
    });
  };
  for (int i = 0; i < 6000 && !has_failed(); ++i) r.run_for(10ms);
  ASSERT_TRUE(has_failed());
  r.run_for(10ms);
  Manager::Options options;
  options.start = r.now;
  auto next = std::make_unique<Manager>(r.rules(), std::make_unique<BayesPlanner>(), options);
  next->remember(r.events);
  EXPECT_TRUE(next->knowledge().components[kCamera].is_to_be_given_back());
}

TEST(Orders, NothingIsLearnedFromAStrategyThatWasAbandoned) {
  TestRobot r = robot();
  const Belief before = r.manager().knowledge().beliefs[kRestart];
  begin_restart(r);
  r.order(order(Pause{}), 20s);
  EXPECT_EQ(r.manager().knowledge().beliefs[kRestart], before);
}

TEST(Orders, DryRunCanBeSwitchedOnAndOff) {
  TestRobot r = robot();
  r.order(order(SetDryRun{true}));
  r.fail("camera", "restart", 5s);
  EXPECT_EQ(r.count("would restart camera"), 1u);
  EXPECT_TRUE(r.asked.empty());
  r.order(order(SetDryRun{false}), 5s);
  EXPECT_TRUE(r.works("camera"));
}

TEST(Orders, WhatWasLearnedIsForgotten) {
  TestRobot r = robot();
  const Belief prior = r.manager().knowledge().beliefs[kRestart];
  r.fail("camera", "restart", 5s);
  ASSERT_NE(r.manager().knowledge().beliefs[kRestart], prior);
  r.order(order(Forget{RuleId(99)}));
  EXPECT_NE(r.manager().knowledge().beliefs[kRestart], prior) << "there is no such rule";
  r.manager().set_coupling(kCameraDead, kDark, {3, 1});
  r.order(order(Forget{kDark}));
  EXPECT_TRUE(r.manager().knowledge().couplings.of(kCameraDead, kDark) == Coupling{});
  r.manager().set_coupling(kCameraDead, kDark, {3, 1});
  r.order(order(Forget{}));
  EXPECT_EQ(r.manager().knowledge().beliefs[kRestart], prior);
  EXPECT_TRUE(r.manager().knowledge().couplings.of(kCameraDead, kDark) == Coupling{});
}

TEST(Orders, HowOftenFailuresBeganTogetherIsForgotten) {
  TestRobot r = robot();
  const auto together = [&] {
    return r.manager().knowledge().coincidences.together(kCameraDead, kDark);
  };
  r.manager().set_coincidence(kDark, kCameraDead, 3);
  EXPECT_EQ(together(), 3);
  r.order(order(Forget{kDark}));
  EXPECT_EQ(together(), 0);
  r.manager().set_coincidence(kDark, kCameraDead, 3);
  r.order(order(Forget{}));
  EXPECT_EQ(together(), 0);
}

TEST(Orders, HowLateARuleIsIsForgotten) {
  TestRobot r = robot();
  const auto count = [&] { return r.manager().knowledge().latencies.learned(kDark).count; };
  r.manager().set_latency(kDark, {3, {1s, 2s, 1s}});
  r.order(order(Forget{kCameraDead}));
  EXPECT_EQ(count(), 3);
  r.order(order(Forget{kDark}));
  EXPECT_EQ(count(), 0);
  r.manager().set_latency(kDark, {3, {1s, 2s, 1s}});
  r.order(order(Forget{}));
  EXPECT_EQ(count(), 0);
}

TEST(Orders, ASilencedComponentIsWatchedAndLeftAloneUntilTheSilenceEnds) {
  TestRobot r = robot();
  r.order(order(Silence{kCamera, 10s}, "recalibration"));
  r.fail("camera", "restart", 8s);
  EXPECT_EQ(r.count("CameraDead detected"), 1u);
  EXPECT_EQ(r.count("CameraDead.restart is held back: camera is muted by Ann: recalibration"), 1u);
  EXPECT_TRUE(r.asked.empty());
  r.run_for(8s);
  EXPECT_EQ(r.count("camera is no longer muted"), 1u);
  EXPECT_TRUE(r.works("camera"));
}

TEST(Orders, TheFirstOfTwoSilencesToEndIsWaitedFor) {
  TestRobot r = robot();
  r.order(order(Silence{kCamera, 10s}));
  r.order(order(Silence{kCameraDead, 60s}));
  EXPECT_LE(r.manager().governor().next_deadline(), r.now + 10s);
}

TEST(Orders, ASilencedRuleDoesNotSpendItsRounds) {
  TestRobot r = robot();
  r.order(order(Silence{kCameraDead, {}}));
  r.fail("camera", "restart", 300s);
  EXPECT_EQ(r.count("exhausted"), 0u);
  r.order(order(LiftSilence{kCameraDead}), 5s);
  EXPECT_TRUE(r.works("camera"));
}

TEST(Orders, AStrategyWaitsForApproval) {
  TestRobot r = robot(Approval::kEach);
  r.fail("camera", "restart", 5s);
  EXPECT_EQ(r.count("CameraDead.restart waits for approval: restart camera"), 1u);
  EXPECT_EQ(r.manager().governor().asked(), std::vector{kRestart});
  EXPECT_TRUE(r.asked.empty());
  r.order(order(Approve{kRestart}), 5s);
  EXPECT_TRUE(r.works("camera"));
}

TEST(Orders, ARefusedStrategyMakesRoomForTheNextAndIsAskedForAgainWithTheNextFailure) {
  TestRobot r = robot(Approval::kEach);
  r.fail("camera", "redeploy", 2s);
  r.order(order(Refuse{kRestart}), 2s);
  EXPECT_EQ(r.manager().governor().asked(), std::vector{kRedeploy});
  r.order(order(Approve{kRedeploy}), 10s);
  EXPECT_TRUE(r.works("camera"));
  r.fail("camera", "restart", 2s);
  EXPECT_EQ(r.count("CameraDead.restart waits for approval"), 2u);
}

TEST(Orders, WhatAPersonRefusedHoldsUpNoLesserFailure) {
  Manager::Options options;
  options.governor.approval = Approval::kEach;
  std::string rules = kRules;
  rules.replace(rules.find("light 90"), 8,
                "light 80");  // a sure strategy waits for no other anyway
  TestRobot r(rules, std::make_unique<BayesPlanner>(), options);
  r.add("lamp").parameters["on"] = Value(std::int64_t{0});
  r.add("camera", {"lamp"}, "/rgb");
  r.discover();
  r.signal("brightness", Value(1.0), 1s);
  r["camera"].fault = "a person";
  for (const StrategyId strategy : {kRestart, kRedeploy}) {
    r.run_for(2s);
    r.order(order(Refuse{strategy}));
  }
  r.signal("brightness", Value(0.2), 2s);
  EXPECT_EQ(r.manager().governor().asked(), std::vector{kLight});
}

TEST(Orders, AReconfigurationMayLeadRoundWhatAPersonRefused) {
  Manager::Options options;
  options.governor.approval = Approval::kEach;
  TestRobot r(
      R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT viewer NODE /viewer
RULE CameraDead
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms
    STRATEGY restart 90 10
      ADAPTATION camera restart 2
RULE Blind
  POLICIES WARNING
  TRIGGER age(/view) > 300ms
    STRATEGY other_source 80 10
      ADAPTATION viewer set_parameter source 1 2
    STRATEGY again 80 10
      ADAPTATION viewer restart 2
)",
      std::make_unique<BayesPlanner>(), options);
  r.add("camera", {}, "/rgb");
  r.add("viewer", {"camera"}, "/view").parameters["source"] = Value(std::int64_t{0});
  r.discover(1s);
  r.fail("camera", "a person", 2s);
  ASSERT_EQ(r.manager().governor().asked(), std::vector{StrategyId(0)});
  r.order(order(Refuse{StrategyId(0)}), 2s);
  EXPECT_EQ(r.manager().governor().asked(), std::vector{StrategyId(1)});
  r.order(order(Refuse{StrategyId(1)}), 10s);
  EXPECT_TRUE(r.manager().governor().asked().empty()) << "no restart of it";
}

TEST(Orders, AProposedStrategyBeginsOnlyOnceAPersonApprovesIt) {
  TestRobot r = robot(Approval::kEach);
  r.fail("camera", "redeploy", 1s);
  r.order(order(Propose{kRedeploy}));  // the planner asks for the restart
  r.run_for(30s);
  EXPECT_TRUE(r.asked.empty());
  r.order(order(Approve{kRedeploy}), 5s);
  EXPECT_FALSE(r.was_asked("camera: deactivate"));
  EXPECT_TRUE(r.works("camera"));
}

TEST(Orders, AProposalIsRefusedWhereItMakesNoSense) {
  TestRobot alone = robot();
  alone.fail("camera", "never", 500ms);
  alone.order(order(Propose{kLight}));
  EXPECT_EQ(alone.count("start it with run --approve"), 1u);

  TestRobot r = robot(Approval::kEach);
  r.order(order(Propose{kRedeploy}));
  EXPECT_EQ(r.count("CameraDead needs no strategy now"), 1u);
  r.order(order(Propose{StrategyId(99)}));
  EXPECT_EQ(r.count("there is no such strategy"), 1u);
  r.fail("camera", "redeploy", 1s);
  r.order(order(Propose{kRedeploy}));
  r.order(order(Propose{kRedeploy}));
  EXPECT_EQ(r.count("waits for approval already"), 1u);
  r.order(order(Refuse{kRedeploy}));
  r.order(order(Propose{kRedeploy}));
  EXPECT_EQ(r.count("a person refused redeploy for this failure"), 1u);
  r.run_for(30s);
  EXPECT_TRUE(r.asked.empty());
}

// A pause, and a dry run, hold what a person approves, too.
TEST(Orders, AnApprovedProposalIsHeldByAPause) {
  TestRobot r = robot(Approval::kEach);
  r.fail("camera", "redeploy", 1s);
  r.order(order(Propose{kRedeploy}));
  r.order(order(Pause{}));
  r.order(order(Approve{kRedeploy}), 5s);
  EXPECT_TRUE(r.asked.empty());
  EXPECT_EQ(r.count("it is paused; resume first"), 1u);
}

TEST(Orders, AQuestionLapsesWithItsFailure) {
  TestRobot r = robot(Approval::kEach);
  r.signal("brightness", Value(0.2), 1s);
  r.signal("brightness", Value(0.9), 1s);
  EXPECT_EQ(r.count("Dark.light needs no approval any more"), 1u);
  r.order(order(Approve{kLight}));
  EXPECT_EQ(r.count("Ann is refused: light does not wait for approval"), 1u);
}

TEST(Orders, AStrategyRunByHandActsWithoutItsFailureAndTeachesNothing) {
  TestRobot r = robot();
  const Belief before = r.manager().knowledge().beliefs[kLight];
  r.order(order(RunStrategy{kLight}), 2s);
  EXPECT_EQ(r["lamp"].parameters["on"], Value(std::int64_t{1}));
  EXPECT_EQ(r.count("Dark.light was carried out"), 1u);
  EXPECT_EQ(r.manager().knowledge().states[kDark].phase, RulePhase::kQuiet);
  EXPECT_EQ(r.manager().knowledge().beliefs[kLight], before);
  r.signal("brightness", Value(0.2), 100ms);
  EXPECT_EQ(r.count("Dark detected"), 1u);
}

// A strategy that failed is known to have failed before the next decision: c1, whose silence it
// explains, is not replaced meanwhile.
TEST(Orders, AStrategyRunByHandThatFailsLeavesItsFailureBehindAtOnce) {
  const auto rule = [](const std::string& node) {
    return "COMPONENT " + node + " NODE /" + node + " LAUNCH \"" + node + "\"\nRULE Silent_" +
           node + "\nPOLICIES ERROR\nTRIGGER age(/" + node +
           ") > 350ms\nSTRATEGY redeploy 90 10\nADAPTATION " + node + " redeploy 10\n";
  };
  TestRobot r(rule("c0") + rule("c1"));
  r.add("c0", {}, "/c0").start_time = 900s;
  r.add("c1", {"c0"}, "/c1");
  r.discover(2s);
  r.order(order(RunStrategy{StrategyId(0)}), 300s);
  EXPECT_GE(r.count("redeploy did not resolve Silent_c0"), 1u);
  EXPECT_EQ(r.count("Silent_c0 detected"), 1u);
  EXPECT_FALSE(r.was_asked("c1:"));
}

TEST(Orders, WhatMakesNoSenseIsRefusedWithItsReason) {
  TestRobot r = robot();
  r.order(order(Resume{}));
  r.order(order(LiftSilence{kDark}));
  r.order(order(Silence{ComponentId(99), {}}));
  r.order(order(RunStrategy{StrategyId(r.rules().strategies.size())}));
  r.order(order(Forget{RuleId(r.rules().rules.size())}));
  r.order(order(Pause{}));
  r.order(order(RunStrategy{kLight}));
  EXPECT_EQ(r.count("Ann is refused: it is not paused"), 1u);
  EXPECT_EQ(r.count("Ann is refused: it is not muted"), 1u);
  EXPECT_EQ(r.count("Ann is refused: there is no such component or rule"), 1u);
  EXPECT_EQ(r.count("Ann is refused: there is no such strategy"), 1u);
  EXPECT_EQ(r.count("Ann is refused: there is no such rule"), 1u);
  EXPECT_EQ(r.count("Ann is refused: it is paused; resume first"), 1u);
  EXPECT_TRUE(r.asked.empty());
}

}  // namespace
}  // namespace culprit::test
