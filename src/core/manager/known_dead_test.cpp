// A failure of a process that is known to have exited is planned at once; a person's shutdown is
// respected.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "manager/test_robot.h"

namespace culprit::test {
namespace {

constexpr const char* kPatientRules = R"(
CYCLE 100ms
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion LAUNCH "fusion"
RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/image) > 5s
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 10
)";

TestRobot robot_with(const std::string& rules, const Manager::Options& options = {}) {
  TestRobot robot(rules, std::make_unique<BayesPlanner>(), options);
  robot.add("camera", {}, "/image");
  robot.add("fusion", {"camera"}, "/fused");
  robot.discover();
  robot.tell(EndpointAppeared{"/camera", EndpointKind::kPublisher, "/image"});
  robot.tell(EndpointAppeared{"/fusion", EndpointKind::kPublisher, "/fused"}, 6s);
  return robot;
}

// The time from the end of a component at `ended` to the detection of `rule`.
std::optional<Duration> detected_after(const TestRobot& robot, const std::string& rule,
                                       Time ended) {
  for (const Event& event : robot.events) {
    const auto* detected = std::get_if<FailureDetected>(&event.what);
    if (detected != nullptr && robot.rules()[detected->rule].name == rule && event.at >= ended)
      return event.at - ended;
  }
  return std::nullopt;
}

void end(TestRobot& robot, const std::string& name, const std::string& remark, Cause cause) {
  robot[name].process = ProcessState::kGone;
  robot.tell(ProcessSeen{robot.id(name), ProcessState::kGone, robot[name].pid, remark, cause});
}

TEST(KnownDead, AKilledProcessIsAFailureOfTheRulesThatWouldSeeItsSilence) {
  TestRobot robot = robot_with(kPatientRules);
  const Time killed = robot.now;
  robot.kill("camera", 20ms);
  EXPECT_EQ(detected_after(robot, "CameraSilent", killed), Monitor::kFarewell);
  EXPECT_EQ(
      robot.count("CameraSilent detected (ERROR): camera is known to be down, killed by signal 9"),
      1u);
  EXPECT_TRUE(robot.was_asked("camera: stop process"));
  robot.run_for(3s);
  EXPECT_TRUE(robot.works("camera"));
  EXPECT_EQ(robot.count("CameraSilent resolved by redeploy"), 1u);
}

TEST(KnownDead, AStoppedProcessIsToo) {
  TestRobot robot = robot_with(kPatientRules);
  const Time stopped = robot.now;
  robot.stop("camera");
  EXPECT_EQ(detected_after(robot, "CameraSilent", stopped), Duration());
  EXPECT_EQ(robot.count("camera is known to be down, its process is stopped"), 1u);
}

TEST(KnownDead, WhatGoesOnIsDeadNoLonger) {
  TestRobot robot =
      robot_with(std::string(kPatientRules)
                     .replace(std::string(kPatientRules).find("ERROR"), 5, "ERROR FOR 1s"));
  robot.stop("camera", 500ms);
  robot["camera"].process = ProcessState::kRunning;
  robot.tell(ProcessSeen{robot.id("camera"), ProcessState::kRunning, robot["camera"].pid, ""}, 10s);
  EXPECT_EQ(robot.count("CameraSilent detected"), 0u);
}

TEST(KnownDead, SomebodysWishIsNotAndItsOwnSilenceDecides) {
  for (const Cause cause : {Cause::kWish, Cause::kUnknown}) {
    TestRobot robot = robot_with(kPatientRules);
    const Time ended = robot.now;
    end(robot, "camera", "killed by signal 15", cause);
    robot.run_for(10s);
    const auto after = detected_after(robot, "CameraSilent", ended);
    ASSERT_TRUE(after);
    EXPECT_GT(*after, 4900ms);
    EXPECT_EQ(robot.count("known to be down"), 0u);
  }
}

// It came down in an orderly way, and broke at the end of that.
TEST(KnownDead, AGoodByeOnTheWireIsAWishWhateverTheExitCode) {
  for (const Duration after : {Duration(-50ms), Duration(5ms)}) {
    TestRobot robot = robot_with(kPatientRules);
    const Time ended = robot.now;
    if (after < Duration::zero()) {
      robot.tell(NodeVanished{"/camera"}, -after);
    }
    end(robot, "camera", "killed by signal 11", Cause::kFault);
    robot.run_for(5ms);
    if (after > Duration::zero()) robot.tell(NodeVanished{"/camera"});
    robot.run_for(10s);
    const auto detected = detected_after(robot, "CameraSilent", ended);
    ASSERT_TRUE(detected);
    EXPECT_GT(*detected, 4800ms);
  }
}

// A call or a parameter cannot be verified in a process that is gone, and its changes went with it.
TEST(KnownDead, ItsReplacementDoesNotWaitForWhatWasPendingInIt) {
  for (const bool is_killed : {true, false}) {
    TestRobot robot = robot_with(std::string(kPatientRules) + R"(
RULE Blurred
  POLICIES ERROR
  TRIGGER blur > 0.5
    STRATEGY focus 90 10
      ADAPTATION camera set_parameter angle 1 100
)");
    robot["camera"].parameters = {{"angle", Value(std::int64_t{0})}};
    robot.signal("blur", Value(0.0), 1s);
    robot.signal("blur", Value(1.0), 1s);
    ASSERT_EQ(robot.count("set angle of camera: done"), 1u);
    const StrategyId focus = robot.rules().rules[1].strategies.front();
    const Belief before = robot.manager().knowledge().beliefs[focus];
    is_killed ? robot.kill("camera") : robot.stop("camera");
    robot.run_for(2s);
    EXPECT_EQ(robot.count(is_killed ? "focus did not resolve Blurred: camera exited"
                                    : "focus did not resolve Blurred: camera is stopped"),
              1u);
    EXPECT_TRUE(robot.works("camera"));
    EXPECT_EQ(robot.manager().knowledge().beliefs[focus], before) << "nobody saw whether it helped";
  }
}

TEST(KnownDead, ForAndHoldKeepTheirTime) {
  for (const auto& [policy, time] : {std::pair("FOR 1s", Duration(1s)), {"HOLD 3/5", 200ms}}) {
    TestRobot robot = robot_with(
        std::string(kPatientRules)
            .replace(std::string(kPatientRules).find("ERROR"), 5, std::string("ERROR ") + policy));
    const Time killed = robot.now;
    robot.kill("camera", 4s);
    const auto after = detected_after(robot, "CameraSilent", killed);
    ASSERT_TRUE(after) << policy;
    EXPECT_GE(*after, time) << policy;
    EXPECT_LE(*after, time + 200ms) << policy;
  }
}

TEST(KnownDead, OnlyWhereTheDeadOneAloneExplainsIt) {
  const auto rule_with = [](const std::string& trigger) {
    return std::string(kPatientRules)
        .replace(std::string(kPatientRules).find("age(/image) > 5s"), 16, trigger);
  };
  const auto is_seen_at_once = [&](const std::string& trigger) {
    TestRobot robot = robot_with(rule_with(trigger));
    robot.kill("camera", 20ms);
    return robot.count("CameraSilent detected") == 1;
  };
  EXPECT_TRUE(is_seen_at_once("rate(/image, 10s) < 1"));
  EXPECT_TRUE(is_seen_at_once("phi(/image) > 8"));
  EXPECT_TRUE(is_seen_at_once("rate(/image, 2s) / rate(/fused, 2s) < 0.5"));
  EXPECT_TRUE(is_seen_at_once("age(/image) > 5s && age(/fused) < 1s"));
  // A topic that it does not publish, though that is silent soon.
  EXPECT_FALSE(is_seen_at_once("age(/fused) > 5s"));
  EXPECT_FALSE(is_seen_at_once("age(/image) > 5s && age(/fused) > 5s"));
  // Silence that does not last is none that is known.
  EXPECT_FALSE(is_seen_at_once("age(/image) > 5s && age(/image) < 6s"));
}

TEST(KnownDead, NotWhereAnotherOnePublishesItToo) {
  TestRobot robot = robot_with(kPatientRules);
  robot.tell(EndpointAppeared{"/fusion", EndpointKind::kPublisher, "/image"});
  robot.kill("camera", 4s);
  EXPECT_EQ(robot.count("CameraSilent detected"), 0u);
}

// A mission is called off when the camera did not come back, not when it goes.
TEST(KnownDead, AStrategyThatCannotBringItBackWaitsForOneThatCan) {
  const std::string gone = R"(
RULE CameraGone
  POLICIES ERROR
  TRIGGER age(/image) > 3s
    STRATEGY give_up 90 10
      ADAPTATION fusion set_parameter mission "home" 2
)";
  TestRobot both = robot_with(kPatientRules + gone);
  both.kill("camera", 2s);
  EXPECT_TRUE(both.works("camera"));
  EXPECT_EQ(both.count("CameraGone detected"), 0u);

  const std::string rules(kPatientRules);
  TestRobot alone = robot_with(rules.substr(0, rules.find("RULE")) + gone);
  alone.kill("camera", 20ms);
  EXPECT_EQ(alone.count("CameraGone detected (ERROR): camera is known to be down"), 1u);
}

// It began, and needs a while until its first message: that is neither success nor failure.
TEST(KnownDead, IsResolvedWhenItIsHeardAgain) {
  TestRobot robot = robot_with(kPatientRules);
  robot.kill("camera");
  robot.fail("camera", "warms up", 1s);
  EXPECT_EQ(robot.count("redeploy camera: done"), 1u);
  EXPECT_EQ(robot.count("CameraSilent resolved"), 0u);
  EXPECT_EQ(robot.count("CameraSilent cleared"), 0u);
  robot["camera"].fault = "";
  robot.run_for(2s);
  EXPECT_EQ(robot.count("CameraSilent resolved by redeploy"), 1u);
  EXPECT_EQ(robot.count_asked("camera: start process"), 1u);
}

// As `culprit init` drafts it.
std::string drafted_rules() {
  std::string rules(kPatientRules);
  return rules.replace(rules.find("age(/image) > 5s"), 16, "!alive(camera) || age(/image) > 750ms");
}

// The process is there again at once, and its topic is not.
TEST(KnownDead, IsResolvedWhenItIsHeardAgainAlsoIfTheRuleReadsAlive) {
  TestRobot robot = robot_with(drafted_rules());
  robot.kill("camera");
  robot.fail("camera", "warms up", 1s);
  EXPECT_EQ(robot.count("CameraSilent detected (ERROR)"), 1u);
  EXPECT_EQ(robot.count("known to be down"), 0u) << "the rule sees by itself that it exited";
  EXPECT_EQ(robot.count("redeploy camera: done"), 1u);
  EXPECT_EQ(robot.count("CameraSilent resolved"), 0u);
  robot["camera"].fault = "";
  robot.run_for(5s);
  EXPECT_EQ(robot.count("CameraSilent resolved by redeploy"), 1u);
  EXPECT_EQ(robot.count("CameraSilent detected"), 1u);
  EXPECT_EQ(robot.count_asked("camera: start process"), 1u);
}

// A node was killed whose constructor opens a device before it makes a publisher; its successor is at
// its start.
TestRobot robot_that_starts_slowly() {
  Manager::Options options;
  options.governor = Governor::Options::recommended();
  TestRobot robot(drafted_rules(), std::make_unique<BayesPlanner>(), options);
  robot.add("camera", {}, "/image").has_lifecycle = false;
  robot.add("fusion", {"camera"}, "/fused");
  robot.discover();
  robot.tell(EndpointAppeared{"/camera", EndpointKind::kPublisher, "/image"});
  robot.tell(Probed{robot.id("camera"), true}, 6s);
  robot.kill("camera", 100ms);
  robot.tell(EndpointVanished{"/camera", EndpointKind::kPublisher, "/image"});
  robot["camera"].fault = "warms up";
  return robot;
}

TEST(KnownDead, ANodeThatDoesNotSpeakYetIsNotEndedAgain) {
  TestRobot robot = robot_that_starts_slowly();
  robot.run_for(25s);
  EXPECT_EQ(robot.count_asked("camera: start process"), 1u);
  robot.tell(EndpointAppeared{"/camera", EndpointKind::kPublisher, "/image"});
  robot.tell(Probed{robot.id("camera"), true});
  robot.run_for(2s);  // until it is discovered
  robot["camera"].fault = "";
  robot.run_for(5s);
  EXPECT_EQ(robot.count("CameraSilent resolved by redeploy"), 1u);
  EXPECT_EQ(robot.count_asked("camera: start process"), 1u);
}

// Its start is over once it answers: what it has not made by then it may never make.
TEST(KnownDead, ANodeThatAnswersAndDoesNotSpeakIsReplaced) {
  TestRobot robot = robot_that_starts_slowly();
  robot.run_for(2s);
  robot.tell(Probed{robot.id("camera"), true}, 20s);
  EXPECT_GE(robot.count_asked("camera: start process"), 2u);
}

// A topic on demand need not come again: the process is there, and that is all that can be known.
TEST(KnownDead, ARarelyPublishedTopicIsNotAwaitedForLong) {
  TestRobot robot = robot_with(std::string(kPatientRules)
                                   .replace(std::string(kPatientRules).find("age(/image) > 5s"), 16,
                                            "!alive(camera) || age(/image) > 1h"));
  robot.kill("camera");
  robot.fail("camera", "warms up", 30s);
  EXPECT_EQ(robot.count("CameraSilent resolved by redeploy"), 1u);
  EXPECT_EQ(robot.count_asked("camera: start process"), 1u);
}

TEST(KnownDead, WhatSomebodyElseStartedAgainIsLeftAlone) {
  Manager::Options options;
  options.governor.quiet_at_start = 8s;  // so that nothing is begun for a while
  TestRobot robot = robot_with(kPatientRules, options);
  robot.kill("camera", 100ms);
  EXPECT_EQ(robot.count("CameraSilent detected"), 1u);
  robot.start_by_hand("camera");
  robot.fail("camera", "warms up", 4s);
  robot["camera"].fault = "";
  robot.run_for(10s);
  EXPECT_EQ(robot.count_asked("camera:"), 0u);
}

// Its launcher starts it again (respawn). Its process runs, its node is not there yet.
TEST(KnownDead, WhatALauncherStartedAgainHasItsTimeToComeUp) {
  for (const bool comes_up : {true, false}) {
    Manager::Options options;
    options.governor.quiet_at_start = 6500ms;  // so that nothing is begun before that
    TestRobot robot = robot_with(kPatientRules, options);
    robot.kill("camera", 100ms);
    const int pid = robot["fusion"].pid + 1;  // the next one
    robot.tell(ProcessSeen{robot.id("camera"), ProcessState::kRunning, pid, ""},
               Departures::kBack - 500ms);
    EXPECT_TRUE(robot.asked.empty());
    EXPECT_EQ(robot.count("camera was started again a moment ago, not by culprit"), 1u);
    if (comes_up) robot.start_by_hand("camera");
    robot.run_for(10s);
    EXPECT_EQ(robot.was_asked("camera: stop process"), !comes_up);
  }
}

// A healthy consumer is no culprit while its supplier is being started by somebody else.
TEST(KnownDead, AConsumerOfWhatIsBeingStartedWaits) {
  TestRobot robot = robot_with(R"(
CYCLE 100ms
COMPONENT camera NODE /camera
COMPONENT fusion NODE /fusion LAUNCH "fusion"
RULE FusionSilent
  POLICIES ERROR
  TRIGGER age(/fused) > 500ms
    STRATEGY redeploy 90 10
      ADAPTATION fusion redeploy 10
)");
  robot.kill("camera", 2s);
  EXPECT_EQ(robot.count("FusionSilent waits: it depends on camera, which exited"), 1u);
  const int pid = robot["camera"].pid + 1000;
  robot.tell(ProcessSeen{robot.id("camera"), ProcessState::kRunning, pid, ""});
  robot.tell(Overslept{2s});  // so that it is unknown whether the node is there
  robot.run_for(5s);
  EXPECT_TRUE(robot.asked.empty());
}

TEST(KnownDead, NothingIsBegunInTheQuietTimeAfterItsOwnRedeployment) {
  Manager::Options options;
  options.governor = Governor::Options::recommended();
  TestRobot robot = robot_with(kPatientRules, options);
  robot.kill("camera", 500ms);
  ASSERT_EQ(robot.count("redeploy camera: done"), 1u);
  const Time died_again = robot.now;
  robot.kill("camera", 20s);
  Time begun = kNever;
  for (const Event& event : robot.events) {
    if (std::holds_alternative<StrategyChosen>(event.what) && event.at > died_again)
      begun = std::min(begun, event.at);
  }
  EXPECT_GE(begun - died_again, 1s - 200ms);
  EXPECT_TRUE(robot.works("camera"));
}

// ---- components that a person had their owner stop, or shut down

TEST(AnOwner, ThatWasToldToEndItsProcessIsNotToldToStartItAgain) {
  std::string rules = kPatientRules;
  rules.replace(rules.find("LAUNCH \"camera\""), 15, "UNIT camera.service");
  TestRobot robot = robot_with(rules);
  robot.leave("camera");  // the kernel is faster than systemd
  robot.run_for(500ms);
  robot.tell(ProcessSeen{robot.id("camera"), ProcessState::kGone, robot["camera"].pid,
                         "camera.service is inactive", Cause::kOrder},
             1min);
  EXPECT_TRUE(robot.asked.empty());
  EXPECT_EQ(robot.count("camera stays down: its owner ended it in an orderly way"), 1u);
  robot.start_by_hand("camera", 15s);
  robot.kill("camera", 5s);
  EXPECT_TRUE(robot.works("camera"));
}

// It hangs, culprit has begun to replace it, and a person presses Ctrl-C in its terminal.
TEST(AnOwner, ThatEndsAProcessBeforeCulpritDoesIsNotToldToStartItAgain) {
  TestRobot robot = robot_with(kPatientRules);
  robot["camera"].fault = "redeploy";
  robot["camera"].ends_only_if_killed = true;
  for (int i = 0; i < 300 && !robot.was_asked("camera: stop process"); ++i) robot.run_for(100ms);
  ASSERT_TRUE(robot.was_asked("camera: stop process"));
  end(robot, "camera", "killed by signal 2", Cause::kOrder);
  robot.run_for(1min);
  EXPECT_FALSE(robot.was_asked("camera: start process"));
  EXPECT_EQ(robot.count("camera stays down: it ended in the foreground of a terminal"), 1u);
}

// systemctl freeze, docker pause.
TEST(AnOwner, ThatFreezesAProcessIsNotToldToReplaceItUntilItThaws) {
  TestRobot robot = robot_with(kPatientRules);
  robot["camera"].process = ProcessState::kStopped;
  robot.tell(ProcessSeen{robot.id("camera"), ProcessState::kStopped, robot["camera"].pid, "",
                         Cause::kOrder});
  robot.run_for(1min);
  EXPECT_FALSE(robot.was_asked("camera: st")) << transcript(robot);
  EXPECT_EQ(robot.count("camera stays down: a person froze it"), 1u) << transcript(robot);
  robot["camera"].process = ProcessState::kRunning;
  robot.tell(ProcessSeen{robot.id("camera"), ProcessState::kRunning, robot["camera"].pid, ""});
  robot.run_for(Departures::kBack + 5s);
  EXPECT_FALSE(robot.was_asked("camera: st")) << transcript(robot);
  robot.kill("camera");
  robot.run_for(5s);
  EXPECT_TRUE(robot.works("camera")) << transcript(robot);
}

TEST(AShutdown, OfANodeIsNotUndone) {
  const std::string rules = std::string(kPatientRules) + R"(
RULE CameraInactive
  POLICIES ERROR
  TRIGGER lifecycle(camera) != "active"
    STRATEGY renew 90 10
      ADAPTATION camera redeploy 10
)";
  for (const bool is_shut_down : {true, false}) {
    TestRobot robot = robot_with(rules);
    robot["camera"].state = Lifecycle::kFinalized;
    robot.tell(LifecycleRead{robot.id("camera"), Lifecycle::kFinalized, is_shut_down}, 10s);
    EXPECT_EQ(robot.asked.empty(), is_shut_down);
    EXPECT_EQ(robot.count("camera stays down: its node was shut down"), is_shut_down ? 1u : 0u);
  }
}

// It runs on another computer, which was out of reach for a moment; or a new culprit finds it.
TEST(AShutdown, StandsUntilTheNodeIsInAnotherState) {
  TestRobot robot = robot_with(std::string(kPatientRules) + R"(
RULE CameraInactive
  POLICIES ERROR
  TRIGGER lifecycle(camera) != "active"
    STRATEGY renew 90 10
      ADAPTATION camera redeploy 10
)");
  const ComponentId camera = robot.id("camera");
  robot["camera"].state = Lifecycle::kFinalized;
  robot.tell(LifecycleRead{camera, Lifecycle::kFinalized, true}, 10s);
  robot.tell(NodeVanished{"/camera"}, 1s);
  robot.tell(NodeAppeared{"/camera", 0});
  robot.tell(LifecycleRead{camera, Lifecycle::kFinalized}, 1min);
  EXPECT_FALSE(robot.was_asked(" process")) << transcript(robot);
  EXPECT_TRUE(robot.manager().knowledge().departures.stays_down(camera));
  robot.tell(LifecycleRead{camera, Lifecycle::kInactive});
  EXPECT_FALSE(robot.manager().knowledge().departures.stays_down(camera));
}

// Ctrl-Z in its terminal, and later fg.
TEST(AStop, ByAPersonIsNotUndone) {
  for (const Cause cause : {Cause::kWish, Cause::kFault}) {
    TestRobot robot = robot_with(kPatientRules);
    robot["camera"].process = ProcessState::kStopped;
    robot.tell(
        ProcessSeen{robot.id("camera"), ProcessState::kStopped, robot["camera"].pid, "", cause},
        1min);
    const bool is_of_person = cause == Cause::kWish;
    EXPECT_EQ(robot.was_asked(" process"), !is_of_person);
    EXPECT_EQ(robot.count("camera stays down: a person stopped it in a terminal"),
              is_of_person ? 1u : 0u);
    if (!is_of_person) continue;
    robot["camera"].process = ProcessState::kRunning;
    robot.tell(ProcessSeen{robot.id("camera"), ProcessState::kRunning, robot["camera"].pid, ""},
               15s);
    EXPECT_FALSE(robot.was_asked(" process"));
    EXPECT_TRUE(robot.works("camera"));
    robot.kill("camera", 5s);
    EXPECT_TRUE(robot.was_asked("camera: start process"));
  }
}

// ---- what holds for all rules and all deaths

const std::vector<std::string> kTriggers = {"age(/a) > 400ms",
                                            "age(/a) > 3s",
                                            "rate(/a, 2s) < 3",
                                            "phi(/a) > 6",
                                            "age(/a) > 300ms && age(/b) > 1s",
                                            "age(/a) > 300ms || age(/b) > 1s",
                                            "age(/a) > 1s && age(/b) < 500ms",
                                            "!(rate(/a, 1s) > 5) && rate(/b, 1s) > 1",
                                            "age(/b) > 800ms",
                                            "age(/a) > 1s && age(/a) < 2s"};

// When each rule was detected, on a robot without repairs.
std::vector<std::optional<Duration>> detections(const std::vector<std::string>& triggers,
                                                const std::string& policy, Cause cause,
                                                Duration killed_at) {
  std::string rules = "CYCLE 100ms\nCOMPONENT a NODE /a LAUNCH \"a\"\nCOMPONENT b NODE /b\n";
  for (std::size_t i = 0; i < triggers.size(); ++i) {
    const std::string n = std::to_string(i);
    rules += "RULE R" + n + "\n  POLICIES ERROR " + policy + "\n  TRIGGER " + triggers[i] +
             "\n    STRATEGY s" + n + " 90 10\n      ADAPTATION a redeploy 5\n";
  }
  TestRobot robot(rules, std::make_unique<BayesPlanner>(), Autonomy::kAdvise);
  robot.add("a", {}, "/a");
  robot.add("b", {}, "/b", 70ms);
  robot.discover();
  for (const char* name : {"a", "b"})
    robot.tell(EndpointAppeared{std::string("/") + name, EndpointKind::kPublisher,
                                std::string("/") + name});
  robot.run_for(8s + killed_at);
  const Time killed = robot.now;
  end(robot, "a", "killed by signal 9", cause);
  robot.run_for(20s);
  std::vector<std::optional<Duration>> times;
  for (std::size_t i = 0; i < triggers.size(); ++i)
    times.push_back(detected_after(robot, "R" + std::to_string(i), killed));
  return times;
}

// It is what silence would bring, only sooner; what silence would not bring does not come.
RC_GTEST_PROP(KnownDead, BringsWhatSilenceWouldBringAndNothingElse, ()) {
  std::vector<std::string> triggers;
  for (int i = *rc::gen::inRange(1, 5); i > 0; --i)
    triggers.push_back(*rc::gen::elementOf(kTriggers));
  const auto policy = *rc::gen::element<std::string>("", "FOR 300ms", "HOLD 2/4");
  const auto killed_at = std::chrono::milliseconds(*rc::gen::inRange(0, 300));
  const auto known = detections(triggers, policy, Cause::kFault, killed_at);
  const auto heard = detections(triggers, policy, Cause::kUnknown, killed_at);
  for (std::size_t i = 0; i < triggers.size(); ++i) {
    RC_ASSERT(known[i].has_value() == heard[i].has_value());
    if (known[i]) RC_ASSERT(*known[i] <= *heard[i]);
  }
}

}  // namespace
}  // namespace culprit::test
