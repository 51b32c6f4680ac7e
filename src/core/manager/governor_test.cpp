// The governor (docs/governor.md): limits, storms, interlocks.
#include <gtest/gtest.h>

#include "execute/evidence.h"
#include "manager/test_robot.h"

namespace culprit::test {
namespace {

constexpr const char* kCamera = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE CameraDead
  POLICIES ERROR ATTEMPTS 100
  TRIGGER age(/rgb) > 300ms
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 2
)";

TestRobot one_camera(const Governor::Options& governor, const std::string& rules = kCamera) {
  TestRobot robot(rules, std::make_unique<BayesPlanner>(), Manager::Options{.governor = governor});
  robot.add("camera", {}, "/rgb");
  robot.discover(2s);
  return robot;
}

std::vector<Time> times_of_choices(const TestRobot& robot) {
  std::vector<Time> times;
  for (const Event& event : robot.events) {
    if (std::holds_alternative<StrategyChosen>(event.what)) times.push_back(event.at);
  }
  return times;
}

TEST(Intensity, IsNeverExceededAndSaidOnceWhenItHoldsBack) {
  TestRobot robot = one_camera({.limits = {.per_component = {2, 60s}}});
  robot.fail("camera", "a person", 50s);
  EXPECT_EQ(times_of_choices(robot).size(), 2u);
  EXPECT_EQ(robot.count("CameraDead.redeploy is held back: 2 strategies were begun at camera in "
                        "1min, and no more are allowed"),
            1u);
  EXPECT_EQ(robot.count("exhausted"), 0u) << "what is withheld does not spend a round";
  robot.fail("camera", "redeploy", 30s);
  EXPECT_TRUE(robot.works("camera"));
}

// Each time it was proven well in between: neither attempts nor the budgets of a minute end it.
TEST(Restarts, AreBoundedHoweverFailuresComeAndGoAndThenAPersonIsTold) {
  TestRobot robot = one_camera({.limits = {.restarts = {3, 1h}, .backoff = {1s, 4s, 10s}}});
  for (int time = 0; time < 6; ++time) {
    robot.fail("camera", "redeploy", 60s);
  }
  EXPECT_EQ(times_of_choices(robot).size(), 3u);
  EXPECT_EQ(robot.count("is held back: 3 restarts of camera in 1h, and no more are allowed"), 1u);
  EXPECT_EQ(robot.count("CameraDead is exhausted"), 1u);
  robot["camera"].fault.clear();
  robot.run_for(1h);
  robot.fail("camera", "redeploy", 10s);
  EXPECT_TRUE(robot.works("camera")) << "a person mended it, and the hour is over\n";
}

TEST(Restarts, BeyondTheirBoundAnOrderThatFailsLeavesTheFailureToThePerson) {
  TestRobot robot = one_camera({.limits = {.restarts = {1, 1h}}});
  robot["camera"].dies_at_start = true;
  robot.kill("camera", 60s);
  ASSERT_EQ(robot.count("CameraDead is exhausted"), 1u);
  const std::size_t promised = robot.count("tried again after a back-off");
  robot.order({1, "Ann", "", RunStrategy{StrategyId(0)}}, 30s);
  ASSERT_EQ(robot.count("redeploy did not resolve CameraDead"), 2u);
  EXPECT_EQ(robot.count("tried again after a back-off"), promised);
  EXPECT_EQ(robot.manager().knowledge().states[RuleId(0)].phase, RulePhase::kExhausted);
  robot["camera"].dies_at_start = false;
  robot.run_for(10min);
  EXPECT_TRUE(robot.works("camera")) << "it is started again after a while";
}

TEST(Restarts, WhatRestartsNothingIsTriedBeyondTheirBound) {
  TestRobot robot = one_camera({.limits = {.restarts = {1, 1h}}},
                               std::string(kCamera) +
                                   "    STRATEGY tune 30 10\n"
                                   "      ADAPTATION camera set_parameter gain 1 2\n"
                                   "    STRATEGY give_in 50 10 LASTRESORT WITHIN 40s\n"
                                   "      ADAPTATION camera stop 2\n");
  robot["camera"].parameters["gain"] = Value(std::int64_t{0});
  robot.fail("camera", "a person", 60s);
  EXPECT_EQ(robot.count("(redeploy, "), 1u);
  EXPECT_EQ(robot.count("(tune, "), 2u);
  EXPECT_EQ(robot.count("(give_in, "), 1u);
  EXPECT_EQ(robot.count("CameraDead is exhausted"), 1u);
}

TEST(Backoff, DoublesBetweenRestartsAndBeginsAnewAfterProvenHealth) {
  TestRobot robot = one_camera({.limits = {.backoff = {10s, 60s, 30s}}});
  robot.fail("camera", "a person", 60s);
  const std::vector<Time> times = times_of_choices(robot);
  ASSERT_GE(times.size(), 3u);
  EXPECT_GE(times[1] - times[0], 10s);
  EXPECT_GE(times[2] - times[1], 20s);
  robot.fail("camera", "redeploy", 120s);
  ASSERT_TRUE(robot.works("camera"));
  const std::size_t before = times_of_choices(robot).size();
  robot.fail("camera", "redeploy", 5s);
  EXPECT_EQ(times_of_choices(robot).size(), before + 1) << "at once";
}

TEST(QuietPeriod, NothingIsBegunRightAfterTheStart) {
  TestRobot robot = one_camera({.quiet_at_start = 10s});
  robot.fail("camera", "redeploy", 7s);
  EXPECT_TRUE(robot.asked.empty());
  EXPECT_EQ(robot.count("is held back: culprit started a moment ago"), 1u);
  robot.run_for(5s);
  EXPECT_TRUE(robot.works("camera"));
}

TEST(Interlock, NothingIsBegunUnlessItIsTrue) {
  TestRobot robot = one_camera({}, "INTERLOCK speed < 0.1\n" + std::string(kCamera));
  robot.fail("camera", "redeploy", 2s);
  EXPECT_EQ(robot.count("is held back: INTERLOCK speed < 0.1 is unknown"), 1u);
  robot.signal("speed", Value(1.5), 2s);
  EXPECT_TRUE(robot.asked.empty());
  robot.signal("speed", Value(0.0), 3s);
  EXPECT_TRUE(robot.works("camera"));
}

TEST(Interlock, HoldsForAPersonToo) {
  TestRobot robot = one_camera({}, "INTERLOCK speed < 0.1\n" + std::string(kCamera));
  robot.signal("speed", Value(1.5));
  robot.order({1, "Ann", "", RunStrategy{StrategyId(0)}}, 1s);
  EXPECT_EQ(robot.count("Ann is refused: INTERLOCK speed < 0.1 is false"), 1u);
  EXPECT_TRUE(robot.asked.empty());
}

// Five independent cameras.
std::string many_rules() {
  std::string rules;
  for (const char* c : {"a", "b", "c", "d", "e"}) {
    const std::string name = c;
    rules += "COMPONENT " + name + " NODE /" + name + " LAUNCH \"x\"\nRULE Dead_" + name +
             "\nPOLICIES ERROR\nTRIGGER age(/t" + name +
             ") > 300ms\nSTRATEGY redeploy 90 10\nADAPTATION " + name + " redeploy 2\n";
  }
  return rules;
}

TestRobot five(bool is_chain) {
  TestRobot robot(many_rules(), std::make_unique<BayesPlanner>(),
                  Manager::Options{.governor = {.storm = {.share = 0.6}}});
  std::string last;
  for (const char* c : {"a", "b", "c", "d", "e"}) {
    const std::string name = c;
    robot.add(name, is_chain && !last.empty() ? std::vector{last} : std::vector<std::string>{},
              "/t" + name);
    last = name;
  }
  robot.discover(2s);
  return robot;
}

TEST(Storm, WhenMostIsIllAtOnceNothingIsDoneUntilItIsOver) {
  TestRobot robot = five(false);
  for (const char* c : {"a", "b", "c", "d"}) robot[c].fault = "redeploy";
  robot.run_for(20s);
  EXPECT_EQ(robot.count("a person must look: 4 of 5 components failed at once"), 1u);
  EXPECT_TRUE(robot.asked.empty());
  robot["a"].fault.clear();
  robot.run_for(20s);
  EXPECT_EQ(robot.count("culprit may start strategies again"), 1u);
  for (const char* c : {"b", "c", "d"}) EXPECT_TRUE(robot.works(c)) << c;
}

// The first have been repaired before the last one fails.
TEST(Storm, FailuresThatBeginOneAfterTheOtherAreOne) {
  for (const Duration apart : {400ms, 3000ms}) {
    TestRobot robot = five(false);
    for (const char* c : {"a", "b", "c", "d"}) {
      robot[c].fault = "redeploy";
      robot.run_for(apart);
    }
    const bool is_storm = apart < 1s;
    EXPECT_EQ(robot.count("a person must look: 4 of 5 components failed at once"),
              is_storm ? 1u : 0u);
    EXPECT_EQ(robot.was_asked("d: "), !is_storm);
    robot.run_for(20s);
    for (const char* c : {"a", "b", "c", "d"}) EXPECT_TRUE(robot.works(c)) << c;
  }
}

TEST(Storm, AnotherComputerThatDoesNotAnswerIsNotFiveDeadNodes) {
  TestRobot robot = five(true);
  for (std::size_t c = 0; c < 5; ++c) {
    robot.tell(NodeAppeared{"/" + std::string(1, "abcde"[c]), 0});  // of no process of this one
    robot.tell(ProcessSeen{ComponentId(c), ProcessState::kRunning, 0, ""});
  }
  for (std::size_t i = 0; i < 15; ++i) robot.tell(Probed{ComponentId(i % 5), false});
  robot.fail("a", "redeploy", 20s);
  EXPECT_EQ(robot.count(": 5 of 5 components are on another computer and do not answer"), 1u);
  EXPECT_TRUE(robot.asked.empty());
}

TEST(Storm, OneOfAnotherComputerThatDoesNotAnswerIsNone) {
  TestRobot robot = five(true);
  robot.tell(NodeAppeared{"/a", 0});
  robot.tell(ProcessSeen{ComponentId(0), ProcessState::kRunning, 0, ""});
  for (std::size_t i = 0; i < 3; ++i) robot.tell(Probed{ComponentId(0), false});
  robot.run_for(1s);
  EXPECT_EQ(robot.count("a is lost"), 1u);
  EXPECT_EQ(robot.count("a person must look"), 0u);
}

TEST(Storm, OneCauseUpstreamOfAllIsNone) {
  TestRobot robot = five(true);
  robot.fail("a", "redeploy", 20s);
  EXPECT_EQ(robot.count("a person must look"), 0u);
  EXPECT_TRUE(robot.works("e"));
}

TEST(Intensity, HoldsAmongStrategiesThatAreChosenTogether) {
  TestRobot robot(many_rules(), std::make_unique<BayesPlanner>(),
                  Manager::Options{.governor = {.limits = {.per_kind = {2, 30s}}}});
  for (const char* c : {"a", "b", "c", "d", "e"}) robot.add(c, {}, "/t" + std::string(c));
  robot.discover(2s);
  for (const char* c : {"a", "b", "c", "d", "e"}) robot[c].fault = "redeploy";
  robot.run_for(20s);
  EXPECT_EQ(times_of_choices(robot).size(), 2u);
  robot.run_for(100s);
  for (const char* c : {"a", "b", "c", "d", "e"}) EXPECT_TRUE(robot.works(c)) << c;
}

TEST(Identity, NothingIsDoneToANameThatSeveralNodesHave) {
  TestRobot robot = one_camera({});
  robot.tell(NamesakesSeen{"/camera", 1});
  robot.fail("camera", "redeploy", 5s);
  EXPECT_EQ(robot.count("is held back: several nodes have the name /camera"), 1u);
  EXPECT_TRUE(robot.asked.empty());
  robot.tell(NamesakesSeen{"/camera", 0}, 5s);
  EXPECT_TRUE(robot.works("camera"));
}

// Culprit ended the one too many, or a person did.
TEST(Identity, TheEndOfOneOfTwoIsNoLoss) {
  TestRobot robot = one_camera({});
  robot.tell(NamesakesSeen{"/camera", 1});
  robot.tell(ProcessSeen{ComponentId(0), ProcessState::kGone, robot["camera"].pid, "exit code 0"},
             300ms);
  robot.tell(NodeVanished{"/camera"});
  EXPECT_EQ(robot.count("is lost"), 0u);
  constexpr int kOther = 4711;
  robot["camera"].pid = kOther;
  robot.tell(NodeAppeared{"/camera", kOther});
  robot.tell(NamesakesSeen{"/camera", 0});
  robot.tell(EndpointAppeared{"/camera", EndpointKind::kPublisher, "/rgb"}, 5s);
  EXPECT_TRUE(robot.asked.empty());
  robot.fail("camera", "redeploy", 5s);
  EXPECT_TRUE(robot.works("camera")) << "it goes on being managed";
}

Governor::Options with_evidence() { return {.needs_evidence = true}; }

// A camera, and a fusion that needs it. The strategy against the fusion's silence adapts the
// camera.
TestRobot camera_and_fusion(const std::string& trigger, const Governor::Options& governor) {
  TestRobot robot(
      "COMPONENT camera NODE /camera LAUNCH \"camera\"\n"
      "COMPONENT fusion NODE /fusion LAUNCH \"fusion\"\n"
      "RULE Fused\n POLICIES ERROR\n TRIGGER " +
          trigger +
          "\n  STRATEGY redeploy 90 10\n   ADAPTATION camera redeploy 2\n"
          "RULE Watched\n POLICIES ERROR\n TRIGGER age(/rgb) > 1h\n"
          "  STRATEGY no 1 1\n   ADAPTATION fusion restart 1\n",
      std::make_unique<BayesPlanner>(), Manager::Options{.governor = governor});
  robot.add("camera", {}, "/rgb");
  robot.add("fusion", {"camera"}, "/fused");
  robot.discover();
  robot.tell(EndpointAppeared{"/camera", EndpointKind::kPublisher, "/rgb"});
  robot.tell(EndpointAppeared{"/fusion", EndpointKind::kPublisher, "/fused"}, 2s);
  return robot;
}

TopicId rgb_of(TestRobot& robot) {
  const auto& topics = robot.rules().topics;
  const auto rgb = std::find_if(topics.begin(), topics.end(),
                                [](const Topic& topic) { return topic.name == "/rgb"; });
  return TopicId(static_cast<std::size_t>(rgb - topics.begin()));
}

// It pauses for 2 s when it is well, so that its silence proves nothing for 3 s; and by then it was asked to end.
TEST(Evidence, ThatANodeHangsCountsAlsoWhileItIsAskedToEnd) {
  TestRobot robot = one_camera(with_evidence(), R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Silent
  POLICIES ERROR
  TRIGGER age(/rgb) > 2300ms
    STRATEGY again 90 10
      ADAPTATION camera redeploy 5
)");
  TestRobot::Component& camera = robot["camera"];
  camera.ends_only_if_killed = true;
  const auto ask = [&](bool answers) { robot.tell(Probed{ComponentId(0), answers}, 400ms); };
  robot.tell(EndpointAppeared{"/camera", EndpointKind::kPublisher, "/rgb"});
  camera.fault = "it pauses";
  for (int i = 0; i < 5; ++i) ask(true);
  camera.fault.clear();
  for (int i = 0; i < 3; ++i) ask(true);
  camera.fault = "redeploy";
  const Time began = robot.now;
  while (robot.now < began + 2800ms) ask(false);
  EXPECT_EQ(robot.count_asked("camera: stop process"), 1u);
  EXPECT_EQ(robot.count("camera is lost"), 0u);
  while (robot.now < began + 4s) ask(false);
  EXPECT_EQ(robot.count_asked("camera: stop process"), 2u);
  EXPECT_EQ(robot.count_asked("camera: start process"), 1u);
}

// It is silent for 3 s when it is well, so its rule fires before that it hangs is proven. A transition
// would need its answer.
TEST(Evidence, ANodeThatOwesItsAnswersIsAskedForNoTransition) {
  TestRobot robot = one_camera(with_evidence(), R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Silent
  POLICIES ERROR
  TRIGGER age(/rgb) > 3500ms
    STRATEGY gently 90 10
      ADAPTATION camera restart 2
    STRATEGY again 50 10
      ADAPTATION camera redeploy 5
)");
  TestRobot::Component& camera = robot["camera"];
  const auto ask = [&](bool answers) { robot.tell(Probed{ComponentId(0), answers}, 400ms); };
  robot.tell(EndpointAppeared{"/camera", EndpointKind::kPublisher, "/rgb"});
  camera.fault = "it pauses";
  for (int i = 0; i < 8; ++i) ask(true);
  camera.fault.clear();
  for (int i = 0; i < 3; ++i) ask(true);
  camera.fault = "redeploy";
  camera.answers = false;
  const Time began = robot.now;
  while (robot.now < began + 4500ms) ask(false);
  EXPECT_EQ(robot.count("camera is lost: its process runs"), 0u);
  EXPECT_EQ(robot.count("(gently"), 0u);
  EXPECT_TRUE(robot.was_asked("camera: start process"));
}

// A hung component gets no SIGTERM first, which would take seconds.
TEST(Evidence, IsAwaitedWhereAnAnswerIsOverdue) {
  for (const bool hangs : {true, false}) {
    TestRobot robot = one_camera(with_evidence());
    const auto ask = [&](bool answers) { robot.tell(Probed{ComponentId(0), answers}, 400ms); };
    robot.tell(EndpointAppeared{"/camera", EndpointKind::kPublisher, "/rgb"});
    for (int i = 0; i < 4; ++i) ask(true);
    robot.fail("camera", "redeploy", 200ms);
    const Time began = robot.now;
    robot.run_for(300ms);
    EXPECT_FALSE(robot.was_asked("camera: ")) << "an answer is overdue";
    if (!hangs) {
      ask(true);
      EXPECT_TRUE(robot.was_asked("camera: "));
      continue;
    }
    for (int i = 0; i < 4 && !robot.was_asked("camera: "); ++i) ask(false);
    EXPECT_TRUE(robot.was_asked("camera: "));
    EXPECT_LT(robot.now - began, 2s);
    EXPECT_EQ(robot.count("camera is lost: its process runs, but it does not answer"), 1u);
  }
}

// The rule is faster than the questions: the last answer came just before the silence, and is not overdue.
TEST(Evidence, IsAwaitedWhereNothingWasAnsweredSinceTheSilenceBegan) {
  for (const bool hangs : {true, false}) {
    TestRobot robot = one_camera(with_evidence(), R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Silent
  POLICIES ERROR
  TRIGGER age(/rgb) > 200ms
    STRATEGY again 90 10
      ADAPTATION camera redeploy 5
)");
    robot.tell(EndpointAppeared{"/camera", EndpointKind::kPublisher, "/rgb"});
    robot.tell(Probed{ComponentId(0), true}, 400ms);
    robot.tell(Probed{ComponentId(0), true});
    const Time began = robot.now;
    robot.run_for(100ms);  // one more message
    robot.fail("camera", "redeploy", 299ms);
    EXPECT_FALSE(robot.was_asked("camera: "));
    robot.tell(Probed{ComponentId(0), !hangs}, 249ms);
    EXPECT_FALSE(robot.was_asked("camera: ")) << "it may publish next";
    robot.run_for(11ms);
    EXPECT_EQ(robot.was_asked("camera: stop process"), !hangs);
    while (hangs && !robot.was_asked("camera: ") && robot.now < began + 5s) {
      robot.run_for(400ms);
      robot.tell(Probed{ComponentId(0), false});
    }
    EXPECT_LT(robot.now - began, 2s);
    EXPECT_EQ(robot.count("camera is lost: its process runs, but it does not answer"), hangs);
  }
}

// It answers, and stays silent: each answer is followed by a moment in which it may publish next.
TEST(Evidence, ThatIsAskedForAgainAndAgainTakesNoTurnsWithWhatHoldsAllAlong) {
  for (const bool is_paused : {true, false}) {
    Governor::Options options = with_evidence();
    options.limits.per_component = {1, 60s};
    TestRobot robot = one_camera(options);
    robot.tell(EndpointAppeared{"/camera", EndpointKind::kPublisher, "/rgb"});
    robot["camera"].fault = "a person";
    if (is_paused) robot.order({1, "Ann", "", Pause{}});
    for (int i = 0; i < 20; ++i) {
      robot.tell(Probed{ComponentId(0), true}, 400ms);
    }
    const std::string held = "CameraDead.redeploy is held back: ";
    EXPECT_EQ(robot.count(held + (is_paused ? "paused" : "1 strategy was begun at camera")), 1u);
    EXPECT_LE(robot.count(held), is_paused ? 1u : 2u);
  }
}

TEST(Evidence, WhatRunsAndPublishesIsNotEndedBecauseSomethingElseIsSilent) {
  TestRobot robot = camera_and_fusion("age(/fused) > 300ms", with_evidence());
  robot.fail("fusion", "a person", 20s);
  EXPECT_FALSE(robot.was_asked("camera: "));
  EXPECT_EQ(robot.count("Fused.redeploy is held back: camera runs and publishes /rgb; it does "
                        "not publish the silent topic"),
            1u);
  robot.order({1, "Ann", "", RunStrategy{StrategyId(0)}}, 2s);
  EXPECT_TRUE(robot.was_asked("camera: stop process")) << "a person may know better";
}

// It came twice as late as usual, and a little: that is no silence yet.
TEST(Evidence, AMessageThatIsALittleLateIsNoSilence) {
  TestRobot robot = camera_and_fusion("age(/fused) > 300ms", with_evidence());
  const Duration interval = robot.manager().knowledge().signals.rhythm(rgb_of(robot)).interval;
  robot["camera"].fault = "a person";
  robot["fusion"].fault = "a person";
  const Time last = *robot.manager().knowledge().signals.rhythm(rgb_of(robot)).last;
  const auto& strategy = robot.rules().strategies[0];
  const auto objection = [&](Duration after) {
    return execute::contradiction(strategy, robot.manager().knowledge(), last + after);
  };
  EXPECT_TRUE(objection(2 * interval + 100ms));
  EXPECT_FALSE(objection(2 * interval + 101ms));
}

TEST(Evidence, ItIsEndedOnceItIsSilentItself) {
  TestRobot robot = camera_and_fusion("age(/fused) > 300ms", with_evidence());
  robot.fail("camera", "redeploy", 5s);
  EXPECT_TRUE(robot.works("fusion"));
}

TEST(Evidence, TheSilenceOfOneOfItsTopicsIsEnoughWhateverElseTheRuleReads) {
  TestRobot robot = camera_and_fusion("age(/fused) > 1h || age(/depth) > 300ms", with_evidence());
  robot.tell(EndpointAppeared{"/camera", EndpointKind::kPublisher, "/depth"});
  robot.tell(SampleArrived{TopicId(1), 1}, 5s);
  EXPECT_TRUE(robot.was_asked("camera: stop process"));
}

TEST(Evidence, AProcessThatIsGoneOrStoppedNeedsNoMore) {
  TestRobot robot = camera_and_fusion("age(/fused) > 300ms", with_evidence());
  robot.kill("camera", 5s);
  EXPECT_TRUE(robot.works("fusion"));
  robot.stop("camera", 5s);
  EXPECT_TRUE(robot.works("fusion"));
}

TEST(Evidence, ABadValueIsEnough) {
  TestRobot robot = camera_and_fusion("quality < 0.5 && age(/fused) < 1s", with_evidence());
  robot.signal("quality", Value(0.1), 2s);
  EXPECT_TRUE(robot.was_asked("camera: stop process"));
}

TEST(Evidence, ItsOwnSilenceIsEnough) {
  TestRobot robot = one_camera(with_evidence());
  robot.fail("camera", "redeploy", 5s);
  EXPECT_TRUE(robot.works("camera"));
}

}  // namespace
}  // namespace culprit::test
