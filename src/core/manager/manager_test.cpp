#include "manager/manager.h"

#include <gtest/gtest.h>

#include "manager/test_robot.h"
#include "plan/paper_planner.h"

namespace culprit::test {
namespace {

// camera -> fusion -> segmentation, each with a failure that restart or redeploy resolves.
constexpr const char* kPipeline = R"(
COMPONENT camera       NODE /camera       LAUNCH "camera"
COMPONENT fusion       NODE /fusion       LAUNCH "fusion"
COMPONENT segmentation NODE /segmentation LAUNCH "segmentation"
RULE CameraDead
  POLICIES ERROR
  TRIGGER age(/rgb) > 350ms
    STRATEGY restart 50 10
      ADAPTATION camera restart 3
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 10
RULE FusionDead
  POLICIES ERROR
  TRIGGER age(/fused) > 350ms
    STRATEGY restart 50 10
      ADAPTATION fusion restart 3
    STRATEGY redeploy 90 10
      ADAPTATION fusion redeploy 10
RULE SegmentationDead
  POLICIES ERROR
  TRIGGER age(/segmentation) > 350ms
    STRATEGY restart 50 10
      ADAPTATION segmentation restart 3
    STRATEGY redeploy 90 10
      ADAPTATION segmentation redeploy 10
)";

TestRobot pipeline(std::unique_ptr<const Planner> planner, Autonomy autonomy = Autonomy::kAct) {
  TestRobot robot(kPipeline, std::move(planner), autonomy);
  robot.add("camera", {}, "/rgb");
  robot.add("fusion", {"camera"}, "/fused");
  robot.add("segmentation", {"fusion"}, "/segmentation");
  robot.discover(2s);
  EXPECT_TRUE(robot.asked.empty());
  return robot;
}

std::unique_ptr<const Planner> paper() { return std::make_unique<PaperPlanner>(); }
std::unique_ptr<const Planner> bayes() { return std::make_unique<BayesPlanner>(); }
std::unique_ptr<const Planner> without_dependencies() {
  return std::make_unique<PaperPlanner>(PaperSwitches{.dependencies = false});
}

// Behaviour that holds with every planner.
class ManagerWith : public testing::TestWithParam<PlannerFactory> {
 protected:
  TestRobot pipeline(Autonomy autonomy = Autonomy::kAct) const {
    return test::pipeline(GetParam()(), autonomy);
  }
};
INSTANTIATE_TEST_SUITE_P(EachPlanner, ManagerWith, testing::Values(paper, bayes),
                         [](const auto& test) { return test.index == 0 ? "paper" : "bayes"; });

TEST_P(ManagerWith, RestartsTheRootCauseAndNothingElse) {
  TestRobot robot = pipeline();
  robot.fail("camera", "restart", 5s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_EQ(robot.count("detected"), 3u);
  EXPECT_EQ(robot.count("CameraDead resolved by restart"), 1u);
  EXPECT_EQ(robot.count("FusionDead cleared without a repair of its own"), 1u);
  EXPECT_FALSE(robot.was_asked("fusion:"));
  EXPECT_FALSE(robot.was_asked("segmentation:"));
  EXPECT_EQ(robot.count_asked("camera: deactivate"), 1u);
  EXPECT_EQ(robot.count_asked("camera: activate"), 1u);
}

TEST(Manager, BlamesEveryComponentWithoutTheDependencyGraph) {
  TestRobot robot = pipeline(without_dependencies());
  robot.fail("camera", "restart", 10s);
  EXPECT_TRUE(robot.was_asked("fusion:"));
  EXPECT_TRUE(robot.was_asked("segmentation:"));
}

// An answer to one command must not be taken for one to another.
TEST_P(ManagerWith, NumbersItsCommandsUpwards) {
  TestRobot robot = pipeline();
  std::vector<std::uint64_t> numbers;
  robot.before_commands = [&](std::vector<Observation>&, std::span<const Command> commands) {
    for (const Command& command : commands) numbers.push_back(command.id.number);
    return true;
  };
  robot.fail("camera", "redeploy", 20s);
  EXPECT_GE(numbers.size(), 4u);
  EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end(), std::less_equal<>()));
}

// No message from this robot wakes the manager any more.
TEST(Manager, WakesByItselfToTryAnewAfterAPause) {
  TestRobot robot(
      "COMPONENT camera NODE /camera\n"
      "RULE Blurred\n  POLICIES ERROR ATTEMPTS 4\n  TRIGGER blur > 1\n"
      "    STRATEGY refocus 60 10\n      ADAPTATION camera set_parameter focus 1 5\n");
  robot.add("camera");
  robot.discover(6s);
  robot.signal("blur", Value(2.0), 120s);
  EXPECT_GE(robot.count("camera is held responsible"), 2u);
}

// Its clock is not ours: a time in the future counts as now.
TEST_P(ManagerWith, IsNotCarriedIntoTheFutureByAnObservation) {
  TestRobot robot = pipeline();
  const Observation early{robot.now + 1h, NodeAppeared{"/somebody", 0}};
  EXPECT_TRUE(robot.manager().step(robot.now, {&early, 1}).empty());
  robot.run_for(2s);
  EXPECT_EQ(robot.count("detected"), 0u);
}

TEST_P(ManagerWith, RedeploysWhenARestartDidNotHelp) {
  TestRobot robot = pipeline();
  robot.fail("fusion", "redeploy", 8s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_EQ(robot.count("restart did not resolve FusionDead"), 1u);
  EXPECT_EQ(robot.count("FusionDead resolved by redeploy"), 1u);
  EXPECT_EQ(robot.count("fusion is lost: culprit ended it"), 1u);
  EXPECT_EQ(robot.count_asked("fusion: start process"), 1u);
  EXPECT_FALSE(robot.was_asked("segmentation:"));
}

TEST_P(ManagerWith, RedeploysADeadProcessAtOnce) {
  TestRobot robot = pipeline();
  robot.kill("camera", 5s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_FALSE(robot.was_asked("camera: deactivate")) << "a dead process cannot restart its node";
  EXPECT_EQ(robot.count("camera is lost: killed by signal 9"), 1u);
}

TEST_P(ManagerWith, RedeploysAStoppedProcess) {
  TestRobot robot = pipeline();
  robot.stop("segmentation", 5s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_EQ(robot.count_asked("segmentation: stop process"), 1u);
}

TEST_P(ManagerWith, HealsAHungNodeThatAnswersNothing) {
  TestRobot robot = pipeline();
  robot["fusion"].answers = false;
  robot.fail("fusion", "redeploy", 12s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_EQ(robot.count("restart fusion: failed, it did not answer"), 1u);
}

TEST_P(ManagerWith, KnowsConsumersOfADeadNodeEvenWhenItLeftTheGraph) {
  TestRobot robot = pipeline();
  robot["camera"].start_time = 3s;
  robot.kill("camera", 10s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_FALSE(robot.was_asked("fusion:"));
}

TEST_P(ManagerWith, HealsTwoDeadNodesAtOnce) {
  TestRobot robot = pipeline();
  robot.kill("camera");
  robot.kill("segmentation", 10s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_FALSE(robot.was_asked("fusion:"));
}

TEST_P(ManagerWith, SaysWhatItWouldDoAndDoesNothingInADryRun) {
  TestRobot robot = pipeline(Autonomy::kAdvise);
  robot.fail("camera", "restart", 10s);
  EXPECT_TRUE(robot.asked.empty());
  EXPECT_EQ(robot.count("camera is held responsible for CameraDead and FusionDead and"), 0u);
  EXPECT_EQ(robot.count("would restart camera"), 1u);
}

TEST_P(ManagerWith, GivesUpAfterItsAttempts) {
  TestRobot robot = pipeline();
  robot["camera"].fault = "a person";
  robot.fail("fusion", "restart", 200s);
  EXPECT_EQ(robot.count("CameraDead is exhausted"), 1u);
  EXPECT_EQ(robot.count_asked("camera: start process"), 3u);
  EXPECT_FALSE(robot.was_asked("fusion:")) << "it waits for a person with the camera";
  const std::size_t asked = robot.count_asked("camera:");
  robot.run_for(100s);
  EXPECT_EQ(robot.count_asked("camera:"), asked) << "nothing is tried after exhaustion";
  robot["camera"].fault.clear();
  robot.run_for(2s);
  EXPECT_EQ(robot.count("CameraDead cleared"), 1u) << "an exhausted failure that heals is reported";
}

TEST_P(ManagerWith, LearnsFromVerdicts) {
  TestRobot robot = pipeline();
  const Belief restart = robot.manager().knowledge().beliefs[StrategyId(2)];
  const Belief redeploy = robot.manager().knowledge().beliefs[StrategyId(3)];
  robot.fail("fusion", "redeploy", 8s);
  EXPECT_EQ(robot.manager().knowledge().beliefs[StrategyId(2)],
            (Belief{restart.alpha, restart.beta + 1}));
  EXPECT_EQ(robot.manager().knowledge().beliefs[StrategyId(3)],
            (Belief{redeploy.alpha + 1, redeploy.beta}));
}

TEST(Manager, LearnsNothingFromOutcomesWithTwoCauses) {
  TestRobot robot = pipeline(without_dependencies());
  const Belief before = robot.manager().knowledge().beliefs[StrategyId(4)];
  robot["camera"].fault = "restart";  // all three are restarted; only the camera's restart helps
  robot.run_for(10s);
  EXPECT_EQ(robot.manager().knowledge().beliefs[StrategyId(4)], before);
}

// ---- Couplings.

Coupling coupling(TestRobot& robot, std::size_t cause, std::size_t effect) {
  return robot.manager().knowledge().couplings.of(RuleId(cause), RuleId(effect));
}

TEST(Couplings, LearnWhichFailuresGoAwayWithTheOneThatWasRepaired) {
  TestRobot robot = pipeline(bayes());
  robot.fail("camera", "restart", 10s);
  EXPECT_EQ(coupling(robot, 0, 1), (Coupling{1, 0}));
  EXPECT_EQ(coupling(robot, 0, 2), (Coupling{1, 0}));
  EXPECT_EQ(coupling(robot, 1, 2), Coupling()) << "the camera was repaired, not the fusion";
}

TEST(Couplings, LearnWhichStay) {
  TestRobot robot = pipeline(bayes());
  robot["camera"].fault = "restart";
  robot.fail("fusion", "restart", 20s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_EQ(coupling(robot, 0, 1), (Coupling{0, 1}));
  EXPECT_EQ(coupling(robot, 1, 2), (Coupling{1, 0}));
}

TEST(Couplings, LearnNothingFromOutcomesWithTwoCauses) {
  TestRobot robot = pipeline(without_dependencies());
  robot["camera"].fault = "restart";  // all three are restarted
  robot.run_for(10s);
  for (std::size_t cause = 0; cause < 3; ++cause) {
    for (std::size_t effect = 0; effect < 3; ++effect)
      EXPECT_EQ(coupling(robot, cause, effect), Coupling());
  }
}

TEST(Couplings, LearnThatAStrategyClearsAFailureThatIsNotDownstream) {
  TestRobot robot(R"(
COMPONENT camera NODE /camera
COMPONENT lamp   NODE /lamp
RULE Dark
  POLICIES WARNING
  TRIGGER brightness < 0.5
    STRATEGY light 90 10
      ADAPTATION lamp set_parameter on 1 2
RULE Blurred
  POLICIES NON_CRITICAL
  TRIGGER blur > 0.5
    STRATEGY focus 50 10
      ADAPTATION lamp set_parameter angle 1 2
)");
  robot.add("camera");
  robot.add("lamp").parameters = {{"on", Value(std::int64_t{0})},
                                  {"angle", Value(std::int64_t{0})}};
  robot.discover();
  for (const double brightness : {1.0, 1.0, 0.2}) {
    robot.signal("brightness", Value(brightness));
    robot.signal("blur", Value(1 - brightness), 300ms);
  }
  robot.signal("brightness", Value(1.0));
  robot.signal("blur", Value(0.0), 3s);
  EXPECT_EQ(robot.count("Dark resolved by light"), 1u);
  EXPECT_EQ(coupling(robot, 0, 1), (Coupling{1, 0}));
}

// A reading comes every two seconds: the next one decides, and not the next cycle.
TEST(Couplings, WaitForTheReadingsOfTheEffect) {
  TestRobot robot(R"(
COMPONENT lamp   NODE /lamp
RULE Dark
  POLICIES WARNING
  TRIGGER brightness < 0.5
    STRATEGY light 90 10
      ADAPTATION lamp set_parameter on 1 2
RULE Blurred
  POLICIES NON_CRITICAL
  TRIGGER blur > 0.5
    STRATEGY focus 50 10
      ADAPTATION lamp set_parameter angle 1 2
)");
  robot.add("lamp").parameters = {{"on", Value(std::int64_t{0})},
                                  {"angle", Value(std::int64_t{0})}};
  robot.discover();
  for (int tenth = 0; tenth < 120; ++tenth) {
    robot.signal("brightness", Value(tenth >= 80 && tenth < 83 ? 0.2 : 1.0));
    if (tenth % 20 == 0) robot.signal("blur", Value(tenth == 80 ? 1.0 : 0.0));
    robot.run_for(100ms);
  }
  EXPECT_EQ(robot.count("Dark resolved by light"), 1u);
  EXPECT_EQ(coupling(robot, 0, 1), (Coupling{1, 0}));
}

// ---- How late rules are.

// A lamp whose brightness is measured 2 s after its restart; the rule states 0.4 s.
class LateSensor {
 public:
  LateSensor()
      : robot(R"(
COMPONENT lamp NODE /lamp
RULE Dark
  POLICIES WARNING ATTEMPTS 1
  TRIGGER brightness < 0.5
    STRATEGY again 90 10
      ADAPTATION lamp restart 2
)") {
    robot.add("lamp");
    robot.discover();
    run_for(1s);
  }
  void run_for(Duration time) {
    for (const Time end = robot.now + time; robot.now < end;) {
      const std::size_t restarts = robot.count_asked("lamp: activate");
      if (restarts > restarts_) shown_ = robot.now + 2s;
      restarts_ = restarts;
      if (robot.now >= shown_) brightness = 1;
      robot.signal("brightness", Value(brightness), 50ms);
    }
  }
  void go_dark() {
    shown_ = Time::max();
    brightness = 0;
    run_for(10s);
  }

  TestRobot robot;
  double brightness = 1;

 private:
  std::size_t restarts_ = 0;
  Time shown_ = Time::max();
};

TEST(Latencies, AreLearnedAndAVerdictWaitsForThem) {
  LateSensor sensor;
  sensor.go_dark();
  EXPECT_EQ(sensor.robot.count("again did not resolve Dark"), 1u);
  EXPECT_EQ(sensor.robot.count("Dark resolved by again"), 0u);
  const auto& learned = sensor.robot.manager().knowledge().latencies.learned(RuleId(0));
  EXPECT_EQ(learned.count, 1);
  EXPECT_GE(learned.range.least, 1900ms);
  EXPECT_LE(learned.range.most, 2100ms);
  sensor.run_for(2min);  // it is proven well
  sensor.go_dark();
  EXPECT_EQ(sensor.robot.count("again did not resolve Dark"), 1u);
  EXPECT_EQ(sensor.robot.count("Dark resolved by again"), 1u);
  EXPECT_EQ(learned.count, 2);
}

TEST(Latencies, OfAnEarlierRunAreKnownFromTheBeginning) {
  LateSensor sensor;
  sensor.robot.manager().set_latency(RuleId(0), {1, {2s, 2100ms, 2s}});
  sensor.go_dark();
  EXPECT_EQ(sensor.robot.count("again did not resolve Dark"), 0u);
  EXPECT_EQ(sensor.robot.count("Dark resolved by again"), 1u);
}

TEST(BayesPlanner, LeavesWhatWasRepairedUpstreamTheTimeToSettle) {
  TestRobot robot = pipeline(bayes());
  robot.fail("camera", "redeploy", 20s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_FALSE(robot.was_asked("fusion:"));
}

// ---- Adaptations that go wrong.

constexpr const char* kGain = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Dark
  POLICIES WARNING
  TRIGGER brightness < 0.5
    STRATEGY brighten 90 10
      ADAPTATION camera set_parameter gain 2 2
    STRATEGY more 50 10
      ADAPTATION camera increase_parameter exposure 1 2
)";

TestRobot dark_camera() {
  TestRobot robot(kGain);
  TestRobot::Component& camera = robot.add("camera");
  camera.parameters = {{"gain", Value(1.0)}, {"exposure", Value(std::int64_t{5})}};
  robot.discover();
  robot.signal("brightness", Value(1.0), 1s);
  return robot;
}

TEST(Manager, ProvesAParameterByReadingItBack) {
  TestRobot robot = dark_camera();
  robot.signal("brightness", Value(0.2), 100ms);
  EXPECT_EQ(robot.asked,
            (std::vector<std::string>{"camera: read parameter gain", "camera: set gain to 2.0",
                                      "camera: read parameter gain"}));
  robot.signal("brightness", Value(0.9), 1s);
  EXPECT_EQ(robot.count("Dark resolved by brighten"), 1u);
}

TEST(Manager, IncreasesAParameterByNumbersOfBothKinds) {
  for (const auto& [by, after] : {std::pair{"0.5", 1.5}, std::pair{"2", 3.0}}) {
    TestRobot robot(
        "COMPONENT camera NODE /camera\nRULE Dark\n  POLICIES WARNING\n  TRIGGER light < 0.5\n"
        "    STRATEGY more 90 10\n      ADAPTATION camera increase_parameter gain " +
        std::string(by) + " 5\n");
    robot.add("camera").parameters = {{"gain", Value(1.0)}};
    robot.discover();
    robot.signal("light", Value(1.0), 6s);
    robot.signal("light", Value(0.2), 300ms);
    EXPECT_EQ(robot["camera"].parameters["gain"], Value(after));
  }
}

TEST(Manager, UndoesAStrategyThatFailedBeforeTheNext) {
  TestRobot robot = dark_camera();
  robot.signal("brightness", Value(0.2), 3s);
  EXPECT_EQ(robot["camera"].parameters["gain"], Value(1.0));
  EXPECT_EQ(robot["camera"].parameters["exposure"], Value(std::int64_t{6}));
  const auto place = [&](const std::string& line) {
    return std::find(robot.asked.begin(), robot.asked.end(), line) - robot.asked.begin();
  };
  EXPECT_LT(place("camera: set gain to 1.0"), place("camera: set exposure to 6"));
}

// The journal names the adaptation with each request, and reads it back after a crash.
TEST(Manager, UndoesInTheNameOfAnAdaptationOfTheStrategy) {
  TestRobot robot = dark_camera();
  std::size_t undone = 0;
  robot.before_commands = [&](std::vector<Observation>&, std::span<const Command> commands) {
    for (const Command& command : commands) {
      const auto& adaptations = robot.rules()[command.purpose.strategy].adaptations;
      EXPECT_LT(command.purpose.adaptation, adaptations.size()) << to_string(command);
      if (command.purpose.undoes) ++undone;
    }
    return true;
  };
  robot.signal("brightness", Value(0.2), 3s);
  EXPECT_GE(undone, 1u);
}

// The filter is for the fusion that reads what it sends: both are as before, or neither.
constexpr const char* kFiltered = R"(
COMPONENT fusion NODE /fusion LAUNCH "fusion"
COMPONENT filter NODE /filter LAUNCH "filter"
RULE FusionDead
  POLICIES ERROR
  TRIGGER !alive(fusion)
    STRATEGY again 90 10
      ADAPTATION fusion redeploy 5
RULE FilterDead
  POLICIES WARNING
  TRIGGER !alive(filter)
    STRATEGY filter_again 90 10
      ADAPTATION filter redeploy 5
RULE Unsure
  POLICIES WARNING
  TRIGGER quality < 0.5
    STRATEGY filtered 90 10
      ADAPTATION filter activate 2
      ADAPTATION fusion change_communication input /filtered 2
)";

// Even if a value was to be undone while its process was not there: many nodes keep their
// parameters when they are started again, and culprit brings them to their intended values.
TEST(Manager, UndoesWhatItSetInAProcessThatIsGoneOnceThatIsBack) {
  for (const char* victim : {"fusion", "filter"}) {
    for (Duration killed = 0s; killed < 3s; killed += 50ms) {
      TestRobot robot(kFiltered);
      robot.add("fusion").parameters = {{"input", Value(std::string("/raw"))}};
      TestRobot::Component& filter = robot.add("filter");
      filter.state = filter.state_at_start = Lifecycle::kInactive;
      robot.discover();
      robot.signal("quality", Value(1.0), 6s);
      robot.signal("quality", Value(0.2), killed);
      robot.kill(victim, 40s);
      EXPECT_TRUE(robot.works("fusion"));
      const bool is_filtered =
          robot["fusion"].parameters["input"] == Value(std::string("/filtered"));
      EXPECT_EQ(robot["filter"].state == Lifecycle::kActive, is_filtered)
          << victim << " was killed after " << to_string(killed);
    }
  }
}

// A person brings it back and changes the parameter: a redeploy much later leaves that alone.
TEST(Manager, DoesNotUndoWhatItSetInAProcessThatSomebodyElseStartedAgain) {
  int forgotten = 0;
  for (Duration killed = 0s; killed < 3s; killed += 50ms) {
    TestRobot robot(R"(
COMPONENT fusion NODE /fusion LAUNCH "fusion"
COMPONENT filter NODE /filter LAUNCH "filter"
RULE Unsure
  POLICIES WARNING
  TRIGGER quality < 0.5
    STRATEGY filtered 90 10
      ADAPTATION fusion change_communication input /filtered 2
      ADAPTATION filter activate 2
RULE Wrong
  POLICIES ERROR
  TRIGGER is_wrong
    STRATEGY again 90 10
      ADAPTATION fusion redeploy 5
)");
    robot.add("fusion").parameters = {{"input", Value(std::string("/raw"))}};
    robot.add("filter").fails_to_activate = true;
    robot["filter"].state = robot["filter"].state_at_start = Lifecycle::kInactive;
    robot.discover();
    robot.signal("quality", Value(1.0));
    robot.signal("is_wrong", Value(false), 6s);
    robot.signal("quality", Value(0.2), killed);
    robot.kill("fusion", 3s);
    robot.signal("quality", Value(1.0));
    robot.start_by_hand("fusion", 5s);
    robot["fusion"].parameters["input"] = Value(std::string("/mine"));
    robot.signal("is_wrong", Value(true), 10s);
    EXPECT_TRUE(robot.was_asked("fusion: start"));
    EXPECT_EQ(robot["fusion"].parameters["input"], Value(std::string("/mine")));
    forgotten += robot.count("cannot be undone: fusion: input = ") == 1 ? 1 : 0;
  }
  EXPECT_GT(forgotten, 0);
}

TEST(Manager, SettlesALostReplyByReadingBack) {
  TestRobot robot = dark_camera();
  robot["camera"].loses_replies = true;
  robot.signal("brightness", Value(0.2), 1500ms);
  robot.signal("brightness", Value(0.9), 1s);
  EXPECT_EQ(robot.count_asked("set gain"), 1u) << "nothing is sent twice";
  EXPECT_EQ(robot.count("Dark resolved by brighten"), 1u);
}

TEST(Manager, IsNotHeldUpByAnAnswerThatComesWhenNobodyWaitsForItAnyMore) {
  TestRobot robot = dark_camera();
  robot["camera"].lateness = 1050ms;  // after the manager's own time-out, before its next look
  robot.after_step = [&] { robot["camera"].answers = !robot.was_asked("set gain"); };
  robot.signal("brightness", Value(0.2), 20s);
  EXPECT_EQ(robot.count("Dark is exhausted"), 1u);
}

TEST(Manager, NoticesAParameterThatIsAcceptedAndIgnored) {
  TestRobot robot = dark_camera();
  robot["camera"].ignores_parameters = true;
  robot.signal("brightness", Value(0.2), 1s);
  EXPECT_EQ(robot.count("accepted, but it reads back 1.0"), 1u);
}

TEST(Manager, GoesOnWhenAParameterIsRefusedOrUnknown) {
  TestRobot robot = dark_camera();
  robot["camera"].parameters.erase("gain");
  robot.signal("brightness", Value(0.2), 1s);
  EXPECT_EQ(robot.count("set gain of camera: failed, no parameter gain"), 1u);
  EXPECT_TRUE(robot.was_asked("set exposure to 6"));
}

TEST_P(ManagerWith, TreatsARestartWhoseRepliesAreLostAsDone) {
  TestRobot robot = pipeline();
  robot["camera"].fault = "restart";
  robot["camera"].loses_replies = true;
  robot.run_for(20s);
  EXPECT_TRUE(robot.works("camera"));
  EXPECT_EQ(robot.count_asked("camera: deactivate"), 1u);
  EXPECT_EQ(robot.count_asked("camera: activate"), 1u);
  EXPECT_FALSE(robot.was_asked("camera: start process"));
}

TEST_P(ManagerWith, BringsARelaunchedLifecycleNodeBackToWhereItWas) {
  TestRobot robot = pipeline();
  robot["camera"].state_at_start = Lifecycle::kUnconfigured;
  robot.kill("camera", 10s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_EQ(robot.count_asked("camera: configure"), 1u);
  EXPECT_EQ(robot.count_asked("camera: activate"), 1u);
}

// The process came anew by itself, and unconfigured: `respawn` in a launch file.
TEST(Manager, BringsWhatSomebodyElseRelaunchedBackToWhereItWas) {
  TestRobot robot(R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE CameraDead
  POLICIES ERROR
  TRIGGER age(/rgb) > 500ms
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 2
)");
  robot.add("camera", {}, "/rgb").state_at_start = Lifecycle::kUnconfigured;
  robot.discover(2s);
  robot["camera"].state = Lifecycle::kUnconfigured;
  robot["camera"].pid = 90;
  robot.tell(NodeAppeared{"/camera", 90});
  robot.tell(LifecycleRead{ComponentId(0), Lifecycle::kUnconfigured}, 10s);
  EXPECT_TRUE(robot.works("camera"));
}

TEST_P(ManagerWith, ReportsAComponentThatDiesAtEveryStart) {
  TestRobot robot = pipeline();
  robot["camera"].dies_at_start = true;
  robot.kill("camera", 120s);
  EXPECT_GE(robot.count("it exited at once: exit code 1"), 2u);
  EXPECT_EQ(robot.count("CameraDead is exhausted"), 1u);
}

// As with run --launch.
TEST(Manager, StartsAComponentThatIsNotThereAndCountsAsSeen) {
  TestRobot robot(R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Missing
  POLICIES ERROR
  TRIGGER !alive(camera) || age(/rgb) > 1s
    STRATEGY start 90 10
      ADAPTATION camera start 5
)");
  robot.add("camera", {}, "/rgb").process = ProcessState::kGone;
  robot.manager().remember(KnownRobot{{{"camera", "/camera", {}}}, {"/rgb"}});
  robot.run_for(4s);
  EXPECT_TRUE(robot.said.empty()) << "discovery may still be under way";
  robot.run_for(10s);
  EXPECT_EQ(robot.count("Missing resolved by start"), 1u);
}

TEST(Health, OneRulesRecoveryDoesNotWipeAnothers) {
  TestRobot robot(R"(
COMPONENT camera NODE /camera
COMPONENT fusion NODE /fusion
RULE CameraDead
  POLICIES ERROR
  TRIGGER dead > 0
    STRATEGY s 50 10
      ADAPTATION camera set_parameter p 1 100
RULE Focus
  POLICIES NON_CRITICAL
  TRIGGER blur > 0
    STRATEGY s 50 10
      ADAPTATION camera set_parameter q 1 1
RULE FusionDead
  POLICIES ERROR
  TRIGGER silent > 0
    STRATEGY s 50 10
      ADAPTATION fusion set_parameter p 1 1
)");
  robot.add("camera").parameters = {{"p", Value(std::int64_t{0})}, {"q", Value(std::int64_t{0})}};
  robot.add("fusion", {"camera"}).parameters["p"] = Value(std::int64_t{0});
  robot.discover();
  for (const char* x : {"dead", "blur", "silent"}) robot.signal(x, Value(0.0));
  robot.signal("blur", Value(1.0));
  robot.signal("dead", Value(1.0), 100ms);
  robot.signal("blur", Value(0.0), 1s);
  EXPECT_EQ(robot.count("Focus cleared"), 1u);
  robot.signal("silent", Value(1.0), 2s);
  EXPECT_FALSE(robot.was_asked("fusion:")) << "the camera is still sick";
  EXPECT_EQ(
      robot.count("FusionDead waits: it depends on camera, which may be the cause (CameraDead)"),
      1u);
}

}  // namespace
}  // namespace culprit::test
