// A launch that is being ended is left down, with all that stands in for a part of it.

#include <gtest/gtest.h>

#include "manager/test_robot.h"

namespace culprit::test {
namespace {

constexpr const char* kFiveRules = R"(
CYCLE 100ms
COMPONENT a NODE /a LAUNCH "a"
COMPONENT b NODE /b LAUNCH "b"
COMPONENT c NODE /c LAUNCH "c"
COMPONENT d NODE /d LAUNCH "d"
COMPONENT e NODE /e LAUNCH "e"
RULE A
  POLICIES ERROR
  TRIGGER age(/a) > 300ms
    STRATEGY redeploy_a 90 10
      ADAPTATION a redeploy 5
RULE B
  POLICIES ERROR
  TRIGGER age(/b) > 300ms
    STRATEGY redeploy_b 90 10
      ADAPTATION b redeploy 5
RULE C
  POLICIES ERROR
  TRIGGER !alive(c)
    STRATEGY redeploy_c 90 10
      ADAPTATION c redeploy 5
RULE D
  POLICIES ERROR
  TRIGGER rate(/d, 1s) < 1
    STRATEGY redeploy_d 90 10
      ADAPTATION d redeploy 5
RULE E
  POLICIES ERROR
  TRIGGER phi(/e) > 5
    STRATEGY redeploy_e 90 10
      ADAPTATION e redeploy 5
)";
constexpr int kLauncher = 50;
const std::vector<std::string> kFive = {"a", "b", "c", "d", "e"};

TestRobot launch_of_five(const Manager::Options& options = {}) {
  TestRobot robot(kFiveRules, std::make_unique<BayesPlanner>(), options);
  for (const std::string& name : kFive) robot.add(name, {}, "/" + name).launcher = kLauncher;
  robot.discover();
  for (const std::string& name : kFive) {
    robot.tell(EndpointAppeared{"/" + name, EndpointKind::kPublisher, "/" + name});
    robot.tell(LauncherSeen{robot.id(name), kLauncher, false});
  }
  robot.run_for(6s);
  return robot;
}

Manager::Options reviving() {
  Manager::Options options;
  options.governor.revives_in_doubt = true;
  return options;
}

void end_launcher(TestRobot& robot) {
  for (const std::string& name : kFive) robot.tell(LauncherSeen{robot.id(name), kLauncher, true});
}

TEST(ALaunch, OfFiveThatSomebodyEndsIsNotStartedAgain) {
  TestRobot robot = launch_of_five();
  for (const std::string& name : kFive) {
    robot.leave(name);
    robot.run_for(name == "a" ? 1500ms : 300ms);  // an interpreter takes its time
  }
  end_launcher(robot);
  robot.run_for(1min);
  EXPECT_TRUE(robot.asked.empty());
  EXPECT_EQ(robot.count("A.redeploy_a is held back: the launch of process 50 is being ended"), 1u);
  EXPECT_EQ(robot.count("is held back: a person ended the launch of process 50"), 5u);
  EXPECT_EQ(robot.count("a, b, c, d and e stay down: a person ended the launch of process 50"), 1u);
  for (const std::string& name : kFive) robot.start_by_hand(name);
  robot.run_for(Departures::kBack);
  EXPECT_TRUE(robot.asked.empty());
  robot.kill("b", 2s);
  EXPECT_TRUE(robot.works("b"));
}

// Ctrl-C on `ros2 run` in a terminal: its shell goes on, and no launch ends.
TEST(ALaunch, OfAShellThatGoesOnIsNotBroughtBackAgainstAPersonsWish) {
  TestRobot robot = launch_of_five();
  robot["c"].end();
  robot.tell(NodeVanished{"/c"});
  robot.tell(
      ProcessSeen{robot.id("c"), ProcessState::kGone, robot["c"].pid, "exit code 0", Cause::kOrder},
      1min);
  EXPECT_TRUE(robot.asked.empty());
  EXPECT_EQ(robot.count("c stays down: "), 1u);
  robot.start_by_hand("c", Departures::kBack + 5s);
  robot.kill("c", 5s);
  EXPECT_TRUE(robot.works("c"));
}

// e outlives its launch (nohup, a launcher of its own). From then on it is repaired as any other.
TEST(ALaunch, DoesNotTakeAlongWhatOutlivesIt) {
  for (const bool is_killed : {false, true}) {
    TestRobot robot = launch_of_five();
    for (const std::string name : {"a", "b", "c", "d"}) robot.leave(name);
    end_launcher(robot);
    robot["e"].launcher = 0;
    robot.run_for(Departures::kAlone + 1s);
    if (is_killed) robot.kill("e");
    if (!is_killed) robot.stop("e");
    robot.run_for(1min);
    EXPECT_TRUE(robot.works("e"));
    EXPECT_EQ(robot.count("a, b, c and d stay down"), 1u);
    EXPECT_EQ(robot.count("e stays down"), 0u);
  }
}

// It lived on when its launch ended. Later culprit ends it, while a last resort is under way beside: no person did that.
TEST(ALaunch, DoesNotTakeAlongWhatCulpritEndsBesideALastResort) {
  TestRobot robot(R"(
CYCLE 100ms
COMPONENT a NODE /a LAUNCH "a"
COMPONENT b NODE /b LAUNCH "b"
COMPONENT c NODE /c LAUNCH "c"
RULE A
  POLICIES ERROR
  TRIGGER age(/a) > 300ms
    STRATEGY redeploy_a 90 10
      ADAPTATION a redeploy 30
    STRATEGY safe 100 10 LASTRESORT WITHIN 500ms
      ADAPTATION a set_parameter safe 1 1
)");
  for (const std::string name : {"a", "b", "c"})
    robot.add(name, {}, "/" + name).parameters["safe"] = Value(std::int64_t{0});
  robot.discover();
  for (const std::string name : {"a", "b", "c"})
    robot.tell(LauncherSeen{robot.id(name), kLauncher, false});
  robot.run_for(6s);
  for (const std::string name : {"b", "c"}) robot.leave(name);
  for (const std::string name : {"a", "b", "c"})
    robot.tell(LauncherSeen{robot.id(name), kLauncher, true});
  robot.run_for(Departures::kAlone + 1s);
  robot.fail("a", "redeploy", 1min);
  EXPECT_TRUE(robot.was_asked("a: stop process"));
  EXPECT_TRUE(robot.was_asked("a: read parameter safe"));
  EXPECT_EQ(robot.count("a stays down"), 0u);
  EXPECT_TRUE(robot.works("a"));
}

// A strategy that only sets a parameter ends no process.
TEST(ALaunch, ThatSomebodyEndsDuringAReconfigurationIsNotStartedAgain) {
  TestRobot robot(R"(
CYCLE 100ms
COMPONENT a NODE /a LAUNCH "a"
COMPONENT b NODE /b LAUNCH "b"
SIGNAL drift TOPIC /a FIELD drift
RULE A
  POLICIES ERROR
  TRIGGER age(/a) > 300ms
    STRATEGY redeploy_a 90 10
      ADAPTATION a redeploy 5
RULE Drift
  POLICIES WARNING
  TRIGGER drift > 1
    STRATEGY tune 90 50
      ADAPTATION a set_parameter gain 1 30
)");
  for (const std::string name : {"a", "b"})
    robot.add(name, {}, "/" + name).parameters["gain"] = Value(0.0);
  robot.discover();
  for (const std::string name : {"a", "b"})
    robot.tell(LauncherSeen{robot.id(name), kLauncher, false});
  robot.signal("drift", 0.0, 6s);
  robot.signal("drift", 2.0, 500ms);
  EXPECT_TRUE(robot.was_asked("a: set gain"));
  for (const std::string name : {"a", "b"}) robot.leave(name);
  for (const std::string name : {"a", "b"})
    robot.tell(LauncherSeen{robot.id(name), kLauncher, true});
  robot.run_for(1min);
  EXPECT_FALSE(robot.was_asked("a: start process"));
  EXPECT_EQ(robot.count("a and b stay down: a person ended the launch"), 1u);
}

// b and c run on after their launcher has ended. culprit ends b, and that is no end of the launch.
TEST(ALaunch, IsNotEndedByWhatCulpritEndsAfterItsLauncher) {
  TestRobot robot = launch_of_five();
  for (const std::string name : {"a", "d", "e"})
    robot.tell(LauncherSeen{robot.id(name), kLauncher + 1, false});
  robot.leave("c", 200ms);
  for (const std::string name : {"b", "c"})
    robot.tell(LauncherSeen{robot.id(name), kLauncher, true});
  robot.run_for(Departures::kAlone + 1s);
  robot["b"].launcher = 0;
  robot.fail("b", "redeploy", 30s);
  EXPECT_TRUE(robot.works("b"));
}

// A process that ignores SIGTERM is killed by its launcher.
TEST(ALaunch, ThatSomebodyEndsMayHaveToKill) {
  TestRobot robot = launch_of_five();
  for (const std::string name : {"a", "b", "c", "d"}) robot.leave(name);
  robot.run_for(10s);
  robot.kill("e", 100ms);
  end_launcher(robot);
  robot.run_for(1min);
  EXPECT_TRUE(robot.asked.empty());
}

TEST(ALaunch, OfWhichOneAloneEndedIsCompletedAgain) {
  TestRobot robot = launch_of_five();
  const Time left = robot.now;
  robot.leave("b", 5s);
  EXPECT_TRUE(robot.works("b"));
  const auto chosen = std::ranges::find_if(robot.events, [](const Event& event) {
    return std::holds_alternative<StrategyChosen>(event.what);
  });
  ASSERT_NE(chosen, robot.events.end());
  EXPECT_GE(chosen->at - left, Departures::kAlone);
}

// on_exit=Shutdown(), or a quick person.
TEST(ALaunch, ThatEndsSoonAfterACrashStaysDownAndSaysWhy) {
  TestRobot robot = launch_of_five();
  robot.kill("a", 500ms);
  for (const std::string name : {"b", "c", "d", "e"}) robot.leave(name);
  robot.run_for(200ms);
  end_launcher(robot);
  robot.run_for(100ms);
  EXPECT_EQ(robot.count("stay down: the launch of process 50 ended 500 ms after a crashed"), 1u);
  EXPECT_TRUE(robot.manager().knowledge().departures.stays_down(robot.id("a")));
  const std::size_t asked = robot.asked.size();
  robot.run_for(1min);
  EXPECT_EQ(robot.asked.size(), asked);
  robot.order({1, "anna", "", Revive{}}, 1min);
  for (const std::string name : {"b", "c", "d", "e"}) EXPECT_TRUE(robot.works(name)) << name;
  EXPECT_FALSE(robot.manager().knowledge().departures.stays_down(robot.id("a")));
}

// Several nodes with on_exit=Shutdown(): ros2 launch is told to end repeatedly, and exits with code 1.
TEST(ALaunch, HasEndedIfItsLauncherExitsWithAnErrorAfterItsNodes) {
  for (const bool has_crashed : {false, true}) {
    TestRobot robot = launch_of_five();
    if (has_crashed) robot.kill("a");
    robot.run_for(300ms);
    for (const std::string name : {"b", "c", "d", "e"}) robot.leave(name);
    if (!has_crashed) robot.leave("a");
    robot.run_for(200ms);
    for (const std::string& name : kFive)
      robot.tell(LauncherSeen{robot.id(name), kLauncher, true, true});
    robot.run_for(1min);
    for (const std::string& name : kFive)
      EXPECT_TRUE(robot.manager().knowledge().departures.stays_down(robot.id(name))) << name;
  }
}

// on_exit=Shutdown(): its launcher ended the rest because one had broken.
TEST(ALaunch, ThatEndsBecauseOneBrokeIsBroughtBackWithRevive) {
  TestRobot robot = launch_of_five(reviving());
  robot.kill("a", 50ms);
  for (const std::string name : {"b", "c", "d", "e"}) robot.leave(name);
  robot.run_for(200ms);
  end_launcher(robot);
  robot.run_for(1min);
  for (const std::string& name : kFive) EXPECT_TRUE(robot.works(name)) << name;
}

TEST(ALaunch, ThatEndsBecauseCulpritEndedOneIsBroughtBack) {
  TestRobot robot = launch_of_five();
  robot["a"].fault = "redeploy";
  robot.after_step = [&] { robot.after_step = nullptr; };
  while (!robot.was_asked("a: stop process")) robot.run_for(10ms);
  robot.run_for(10ms);
  for (const std::string name : {"b", "c", "d", "e"}) robot.leave(name);
  end_launcher(robot);
  robot.run_for(1min);
  for (const std::string& name : kFive) EXPECT_TRUE(robot.works(name)) << name;
}

// It had nothing left to run.
TEST(ALaunch, OfOneThatCrashedEndsWithItAndItIsBroughtBack) {
  TestRobot robot = launch_of_five();
  for (const std::string name : {"b", "c", "d", "e"})
    robot.tell(LauncherSeen{robot.id(name), kLauncher + 1, false});
  robot.kill("a");
  robot.tell(LauncherSeen{robot.id("a"), kLauncher, true}, 5s);
  EXPECT_TRUE(robot.works("a"));
  EXPECT_EQ(robot.count("stays down"), 0u);
  robot.kill("a", 20s);
  EXPECT_TRUE(robot.works("a")) << "it stands in for nothing any more";
}

// It ran others, which the rules do not name.
TEST(ALaunch, OfOthersThatEndsSoonAfterACrashStaysDown) {
  TestRobot robot = launch_of_five();
  for (const std::string name : {"b", "c", "d", "e"})
    robot.tell(LauncherSeen{robot.id(name), kLauncher + 1, false});
  robot.kill("a");
  robot.tell(LauncherSeen{robot.id("a"), kLauncher, true, false, true}, 1min);
  EXPECT_EQ(robot.count("a stays down: the launch of process 50"), 1u);
}

// A node in Python that fails with exit code 1, as it also may on Ctrl-C; with a good-bye or without one.
void fail_as_python(TestRobot& robot, const std::string& name, bool says_good_bye) {
  robot[name].end();
  if (says_good_bye) robot.tell(NodeVanished{"/" + name});
  robot.tell(ProcessSeen{robot.id(name), ProcessState::kGone, robot[name].pid, "exit code 1",
                         Cause::kDoubt});
}

TEST(ALaunch, OfNodesInPythonThatSomebodyEndsIsNotStartedAgain) {
  for (const bool says_good_bye : {true, false}) {
    TestRobot robot = launch_of_five(reviving());
    for (const std::string& name : kFive) fail_as_python(robot, name, says_good_bye);
    robot.run_for(300ms);
    end_launcher(robot);
    robot.run_for(1min);
    EXPECT_TRUE(robot.asked.empty());
    EXPECT_EQ(robot.count("a, b, c, d and e stay down: a person ended the launch of process 50"),
              1u);
  }
}

// An exception, or Ctrl-C: nothing tells them apart.
TEST(ALaunch, OfOneNodeInPythonThatFailsStaysDownInDoubtUnlessRevived) {
  for (const bool says_good_bye : {true, false}) {
    for (const bool revives : {false, true}) {
      TestRobot robot = launch_of_five(revives ? reviving() : Manager::Options());
      for (const std::string name : {"b", "c", "d", "e"})
        robot.tell(LauncherSeen{robot.id(name), kLauncher + 1, false});
      fail_as_python(robot, "a", says_good_bye);
      robot.run_for(200ms);
      robot.tell(LauncherSeen{robot.id("a"), kLauncher, true}, 1min);
      EXPECT_EQ(robot.works("a"), revives);
      EXPECT_EQ(robot.count("a stays down: the launch of process 50 ended 200 ms after a crashed"),
                revives ? 0u : 1u);
    }
  }
}

// Its launch goes on, so each of them was an exception.
TEST(ALaunch, OfWhichNodesInPythonFailOneAfterTheOtherIsCompletedSoonEachTime) {
  for (const bool says_good_bye : {true, false}) {
    TestRobot robot = launch_of_five();
    for (const std::string name : {"b", "c", "b", "d"}) {
      fail_as_python(robot, name, says_good_bye);
      robot.run_for(2500ms);
      EXPECT_TRUE(robot.works(name)) << name;
    }
  }
}

// Its launch goes on: it was an exception, or a person ended it alone.
TEST(ALaunch, OfWhichANodeInPythonFailsIsCompletedAgain) {
  for (const bool says_good_bye : {true, false}) {
    TestRobot robot = launch_of_five();
    fail_as_python(robot, "b", says_good_bye);
    robot.run_for(5s);
    EXPECT_TRUE(robot.works("b"));
  }
}

// A process that culprit started in place of a member of a launch ends with the launch, whenever
// that is.
TEST(ALaunch, TakesWhatStandsInForOneOfItAlong) {
  for (const Duration after : {Duration(500ms), Duration(3s), Duration(8s), Duration(30s)}) {
    TestRobot robot = launch_of_five();
    const auto& departures = robot.manager().knowledge().departures;
    robot.kill("a", after);
    for (const std::string name : {"b", "c", "d", "e"}) robot.leave(name);
    robot.run_for(300ms);
    EXPECT_EQ(departures.to_end(robot.id("a")), 0) << "its launcher runs";
    end_launcher(robot);
    robot.run_for(5s);
    for (const std::string& name : kFive)
      EXPECT_TRUE(departures.stays_down(robot.id(name))) << name;
    EXPECT_EQ(departures.to_end(robot.id("a")), robot["a"].pid);
    const std::size_t asked = robot.asked.size();
    robot.leave("a", 1min);
    EXPECT_EQ(robot.asked.size(), asked);
    EXPECT_EQ(robot.count("none helped"), 0u) << "none was tried";
    EXPECT_TRUE(departures.started().empty());
  }
}

// One of two, so that only one of it leaves by itself.
TEST(ALaunch, OfTwoOfWhichOneWasReplacedIsEndedByAPerson) {
  TestRobot robot = launch_of_five();
  for (const std::string name : {"c", "d", "e"})
    robot.tell(LauncherSeen{robot.id(name), kLauncher + 1, false});
  robot.kill("a", 3s);
  ASSERT_TRUE(robot.works("a"));
  const std::size_t asked = robot.asked.size();
  robot.leave("b");
  robot.run_for(8s);  // its launcher takes its time
  EXPECT_EQ(robot.asked.size(), asked);
  robot.tell(LauncherSeen{robot.id("b"), kLauncher, true}, 1min);
  EXPECT_EQ(robot.asked.size(), asked);
  EXPECT_EQ(robot.count("a and b stay down: a person ended the launch of process 50"), 1u);
  EXPECT_FALSE(robot.manager().knowledge().departures.stays_down(robot.id("c")));
}

// It has nothing left to run, and takes its time to end.
TEST(ALaunch, EndsAfterItsLastProcessCrashedAndItsComponentsRunOn) {
  for (const Duration takes : {Duration(200ms), Duration(6s)}) {
    TestRobot robot = launch_of_five();
    for (const std::string name : {"c", "d", "e"})
      robot.tell(LauncherSeen{robot.id(name), kLauncher + 1, false});
    for (const std::string name : {"a", "b"}) {
      robot.kill(name, name == "a" ? 3s : takes);
    }
    robot.tell(LauncherSeen{robot.id("b"), kLauncher, true});
    robot.tell(LauncherSeen{robot.id("a"), kLauncher, true, false, true});  // b ran then
    robot.run_for(1min);
    EXPECT_EQ(robot.count("stay"), 0u);
    for (const std::string name : {"a", "b"}) {
      EXPECT_TRUE(robot.works(name)) << name;
      EXPECT_EQ(robot.manager().knowledge().departures.to_end(robot.id(name)), 0);
    }
  }
}

// Its nodes run on, and so does what stands in for one of them.
TEST(ALaunch, RunsOnIfItsLauncherCrashes) {
  for (const bool is_known : {true, false}) {
    TestRobot robot = launch_of_five();
    robot.kill("a", 3s);
    robot.tell(LauncherSeen{robot.id("b"), kLauncher, true, is_known}, 1min);
    EXPECT_EQ(robot.count("stay"), 0u);
    robot.kill("b", 5s);
    EXPECT_TRUE(robot.works("b"));
    EXPECT_EQ(robot.manager().knowledge().departures.to_end(robot.id("a")), 0);
  }
}

// A strategy that has begun is abandoned.
TEST(ALaunch, ThatEndsWhileOneOfItIsBroughtBackIsNotStartedAgain) {
  TestRobot robot = launch_of_five();
  robot["a"].start_time = 4s;
  robot.kill("a", 2500ms);
  for (const std::string name : {"b", "c", "d", "e"}) robot.leave(name);
  end_launcher(robot);
  robot.run_for(100ms);
  EXPECT_EQ(robot.count("A.redeploy_a is abandoned: a stays down"), 1u);
  robot.run_for(1min);
  EXPECT_EQ(robot.count_asked("start process"), 1u);
  EXPECT_EQ(robot.manager().knowledge().departures.to_end(robot.id("a")), robot["a"].pid);
}

// PIDs are reused.
TEST(ALaunch, IsNotTakenForAnEarlierOneWithItsNumber) {
  TestRobot robot = launch_of_five();
  for (const std::string& name : kFive) robot.leave(name);
  end_launcher(robot);
  robot.run_for(1s);
  for (const std::string& name : kFive) {
    robot.start_by_hand(name);
    robot.tell(LauncherSeen{robot.id(name), kLauncher, false});
  }
  robot.run_for(15s);
  EXPECT_TRUE(robot.asked.empty());
  robot.kill("a", 5s);
  EXPECT_TRUE(robot.works("a"));
}

// Events of an earlier culprit count, until a person orders otherwise.
TEST(ALaunch, ThatWasEndedStaysDownForTheNextCulprit) {
  TestRobot robot = launch_of_five();
  for (const std::string& name : kFive) robot.leave(name);
  end_launcher(robot);
  robot.run_for(1s);
  History past;
  for (const Event& event : robot.events) {
    if (std::holds_alternative<StaysDown>(event.what)) past.push_back(event);
  }
  ASSERT_EQ(past.size(), 1u);
  Manager::Options options;
  options.start = robot.now;
  auto next = std::make_unique<Manager>(robot.rules(), std::make_unique<BayesPlanner>(), options);
  next->remember(past);
  KnownRobot known = robot.manager().knowledge().known_robot();
  next->remember(known);
  robot.replace_manager(std::move(next));
  robot.run_for(1min);
  EXPECT_TRUE(robot.asked.empty());
  robot.order({1, "anna", "", Revive{}}, 1min);
  EXPECT_TRUE(robot.works("c"));
}

// A process that a killed culprit had started stands in for a launch that has ended since.
TEST(ALaunch, ThatEndedWhileNoCulpritRanTakesItsStandInAlong) {
  for (const bool are_others_there : {false, true}) {
    TestRobot robot = launch_of_five();
    if (!are_others_there) {
      for (const std::string name : {"b", "c", "d", "e"})
        robot["" + name].process = ProcessState::kGone;
    }
    Manager::Options options;
    options.start = robot.now;
    robot.replace_manager(
        std::make_unique<Manager>(robot.rules(), std::make_unique<BayesPlanner>(), options));
    robot.tell(StartedHere{robot.id("a"), 400, kLauncher, 1min});
    robot.tell(ProcessSeen{robot.id("a"), ProcessState::kRunning, 400, ""});
    robot.tell(LauncherSeen{robot.id("a"), kLauncher, true});
    if (are_others_there)
      robot.tell(ProcessSeen{robot.id("b"), ProcessState::kRunning, robot["b"].pid, ""});
    robot.run_for(3s);
    const auto& departures = robot.manager().knowledge().departures;
    EXPECT_EQ(departures.to_end(robot.id("a")), are_others_there ? 0 : 400);
    ASSERT_EQ(departures.started().size(), 1u);
    EXPECT_GT(robot.now - departures.started().front().since, 1min);
  }
}

TEST(ALaunch, WhatCulpritStartedIsEndedOnAPersonsOrder) {
  TestRobot robot = launch_of_five();
  robot.order({1, "anna", "", EndStarted{}});
  EXPECT_EQ(robot.count("nothing runs that culprit started"), 1u);
  robot.kill("a", 5s);
  robot.order({2, "anna", "", EndStarted{}}, 100ms);
  EXPECT_EQ(robot.count("a stays down: a person ended the processes that culprit had started"), 1u);
  EXPECT_EQ(robot.manager().knowledge().departures.to_end(robot.id("a")), robot["a"].pid);
  robot.leave("a", 1min);
  EXPECT_EQ(robot.count_asked("start process"), 1u);
  EXPECT_EQ(robot.manager().knowledge().departures.stays_down(robot.id("b")), false);
}

TEST(ALaunch, IsNotInTheWayOfWhatItDidNotStart) {
  TestRobot robot = launch_of_five();
  robot.tell(LauncherSeen{robot.id("e"), kLauncher + 1, false});
  robot.leave("a");
  robot.leave("b");
  robot.kill("e", 1s);
  EXPECT_TRUE(robot.was_asked("e: start process"));
  EXPECT_FALSE(robot.was_asked("a:"));
}

}  // namespace
}  // namespace culprit::test
