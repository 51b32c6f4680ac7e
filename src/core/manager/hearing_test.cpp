// Silence counts only while the robot's messages would have been received: after a sleep, and while
// it is deaf, the manager judges nothing.
#include <gtest/gtest.h>

#include "manager/runtime.h"
#include "manager/test_robot.h"

namespace culprit::test {
namespace {

constexpr const char* kHearingRules = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT lidar  NODE /lidar  LAUNCH "lidar"
COMPONENT estop  NODE /estop
RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/rgb) > 500ms
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 10
RULE LidarSlow
  POLICIES ERROR
  TRIGGER rate(/scan) < 5 || phi(/scan) > 8
    STRATEGY redeploy 90 10
      ADAPTATION lidar redeploy 10
RULE LidarDead
  POLICIES ERROR
  TRIGGER !alive(lidar)
    STRATEGY redeploy 90 10
      ADAPTATION lidar redeploy 10
RULE Blurred
  POLICIES ERROR FOR 2s
  TRIGGER blur > 1
    STRATEGY refocus 60 10
      ADAPTATION camera set_parameter focus 1 5
)";

TestRobot robot() {
  TestRobot robot(kHearingRules);
  robot.add("camera", {}, "/rgb");
  robot.add("lidar", {}, "/scan");
  robot["camera"].parameters["focus"] = Value(std::int64_t{0});
  robot.discover(3s);
  EXPECT_TRUE(robot.said.size() < 3);
  robot.said.clear();
  return robot;
}

// Suspends the robot, and culprit with it, for this time.
void freeze(TestRobot& robot, Duration time) {
  robot.freeze(time);
  robot.tell(Overslept{time});
}

TEST(Hearing, AFrozenRobotIsNotJudgedByItsSleep) {
  TestRobot robot = test::robot();
  freeze(robot, 20s);
  robot.run_for(10s);
  EXPECT_EQ(robot.count("detected"), 0u);
  EXPECT_TRUE(robot.asked.empty());
  EXPECT_EQ(robot.count("did not run for 20.0 s"), 1u);
}

// For a moment, as the runtime tells it.
void stall(TestRobot& robot, Duration time) {
  robot.tell(Overslept{time});
  robot.freeze(time);
}

// As beside a neighbour of real-time priority.
TEST(Hearing, MomentsOfStandingStillDoNotAddUpToASilence) {
  TestRobot robot = test::robot();
  const auto stalls = [&](int times) {
    for (int i = 0; i < times; ++i) {
      stall(robot, 240ms);
      robot.run_for(20ms);
      stall(robot, 240ms);
      robot.run_for(200ms);
    }
  };
  stalls(20);
  EXPECT_EQ(robot.count("CameraSilent detected"), 0u);
  robot["camera"].fault = "redeploy";
  stalls(20);
  EXPECT_EQ(robot.count("CameraSilent detected"), 1u);
  EXPECT_TRUE(robot.works("camera"));
}

TEST(Hearing, ASilenceIsNoticedThoughCulpritStandsStillNearlyAllTheTime) {
  TestRobot robot = test::robot();
  robot["camera"].fault = "redeploy";
  for (int i = 0; i < 20; ++i) {
    stall(robot, 240ms);
    robot.run_for(10ms);
  }
  EXPECT_EQ(robot.count("CameraSilent detected"), 1u);
}

TEST(Hearing, WhatIsSilentAfterASleepIsFoundSilent) {
  TestRobot robot = test::robot();
  robot["camera"].fault = "redeploy";
  freeze(robot, 20s);
  robot.run_for(450ms);
  EXPECT_EQ(robot.count("detected"), 0u);
  robot.run_for(20s);
  EXPECT_TRUE(robot.works("camera"));
  EXPECT_EQ(robot.count_asked("lidar"), 0u);
}

// Its usual gap and 2 s, whatever the rule's own time.
TEST(Hearing, ATopicHasTimeToBeHeardAgainAfterASleep) {
  TestRobot robot = test::robot();
  freeze(robot, 20s);
  robot["camera"].fault = "deaf";
  robot.fail("lidar", "deaf", 1900ms);
  robot["camera"].fault = robot["lidar"].fault = "";
  robot.run_for(10s);
  EXPECT_EQ(robot.count("detected"), 0u);
  EXPECT_TRUE(robot.asked.empty());
}

TEST(Hearing, NothingThatIsDeadIsFoundToWorkByASleep) {
  TestRobot robot = test::robot();
  robot["camera"].fault = "for ever";
  robot.fail("lidar", "for ever", 5s);
  ASSERT_EQ(robot.count("CameraSilent detected"), 1u);
  ASSERT_EQ(robot.count("LidarSlow detected"), 1u);
  for (int i = 0; i < 5; ++i) {
    freeze(robot, 20s);
    robot.run_for(3s);
  }
  EXPECT_EQ(robot.count("resolved"), 0u);
  for (const std::string rule : {"CameraSilent", "LidarSlow"}) {
    EXPECT_EQ(robot.count(rule + " cleared"), 0u);
    EXPECT_EQ(robot.count(rule + " detected"), 1u);
  }
}

// On a machine that has no time for culprit others have none to answer either.
TEST(Hearing, NobodyIsFoundToHangUntilTenSecondsAfterASleep) {
  TestRobot robot(R"(
COMPONENT lidar NODE /lidar LAUNCH "lidar"
RULE LidarDead
  POLICIES ERROR
  TRIGGER !alive(lidar)
    STRATEGY redeploy 90 10
      ADAPTATION lidar redeploy 10
)");
  robot.add("lidar");
  robot.discover(10s);
  const ComponentId lidar(0);
  robot.tell(Probed{lidar, true});
  freeze(robot, 1s);
  const auto goes_unanswered_for = [&](Duration time) {
    for (; time > 0ms; time -= 400ms) {
      robot.run_for(400ms);
      robot.tell(Probed{lidar, false});
    }
  };
  goes_unanswered_for(9s);
  EXPECT_EQ(robot.count("LidarDead detected"), 0u);
  goes_unanswered_for(1600ms);
  EXPECT_EQ(robot.count("LidarDead detected"), 1u);
}

// The same while its lifecycle changes.
TEST(Hearing, NobodyIsFoundToHangWhoseLifecycleHasJustChanged) {
  TestRobot robot(R"(
COMPONENT lidar NODE /lidar LAUNCH "lidar"
RULE LidarDead
  POLICIES ERROR
  TRIGGER !alive(lidar) && lifecycle(lidar) != "finalized"
    STRATEGY redeploy 90 10
      ADAPTATION lidar redeploy 10
)");
  robot.add("lidar");
  robot.discover(10s);
  const ComponentId lidar(0);
  robot.tell(Probed{lidar, true});
  robot.tell(LifecycleRead{lidar, Lifecycle::kInactive});
  for (int i = 0; i < 9; ++i) robot.tell(Probed{lidar, false});
  EXPECT_EQ(robot.count("LidarDead detected"), 0u);
  robot.run_for(2100ms);
  robot.tell(Probed{lidar, false});
  EXPECT_EQ(robot.count("LidarDead detected"), 1u);
}

// Two seconds of every three culprit does not run, while the robot does.
TEST(Hearing, AStarvedManagerDecidesNothing) {
  TestRobot robot = test::robot();
  for (int i = 0; i < 20; ++i) {
    freeze(robot, 2s);
    robot.run_for(1s);
  }
  EXPECT_TRUE(robot.asked.empty());
  EXPECT_EQ(robot.count("detected"), 0u);
}

// Leases expire while no participant announces itself, and culprit notices that when it wakes.
TEST(Hearing, ANodeWhoseLeaseRanOutInASleepIsNotDead) {
  TestRobot robot = test::robot();
  freeze(robot, 20s);
  robot.tell(NodeVanished{"/lidar"}, 3s);
  robot.tell(NodeAppeared{"/lidar", robot["lidar"].pid}, 10s);
  EXPECT_TRUE(robot.asked.empty());
}

TEST(Hearing, ANodeThatDoesNotComeBackAfterASleepIsDead) {
  TestRobot robot = test::robot();
  freeze(robot, 20s);
  robot.tell(NodeVanished{"/lidar"}, 10s);
  EXPECT_TRUE(robot.was_asked("lidar: "));
}

TEST(Hearing, AProcessKnownToBeDeadIsDeadAtOnce) {
  TestRobot robot = test::robot();
  freeze(robot, 20s);
  robot.kill("lidar", 1s);
  EXPECT_EQ(robot.count("LidarDead detected"), 1u);
}

TEST(Hearing, WhatHasToLastBeginsAnewAfterASleep) {
  TestRobot robot = test::robot();
  robot.signal("blur", Value(2.0), 1s);
  freeze(robot, 20s);
  robot.run_for(1900ms);
  EXPECT_EQ(robot.count("Blurred detected"), 0u);
  robot.run_for(200ms);
  EXPECT_EQ(robot.count("Blurred detected"), 1u);
}

TEST(Hearing, NothingIsJudgedWhileDeaf) {
  TestRobot robot = test::robot();
  robot.tell(HearingLost{"nothing came back"});
  EXPECT_FALSE(robot.manager().hears());
  robot["camera"].fault = "deaf";  // as culprit sees it
  robot["lidar"].fault = "deaf";
  robot.tell(NodeVanished{"/lidar"}, 60s);
  EXPECT_EQ(robot.count("detected"), 0u);
  EXPECT_TRUE(robot.asked.empty());
  robot["camera"].fault = robot["lidar"].fault = "";
  robot.tell(HearingRegained{});
  robot.tell(NodeAppeared{"/lidar", robot["lidar"].pid}, 10s);
  EXPECT_TRUE(robot.manager().hears());
  EXPECT_EQ(robot.count("detected"), 0u);
  EXPECT_EQ(robot.count("nothing came back"), 1u);
}

TEST(Hearing, AStrategyUnderWayIsNotBlamedForWhatWasNotHeard) {
  TestRobot robot = test::robot();
  robot["camera"].fault = "redeploy";
  while (!robot.was_asked("camera: start")) robot.run_for(50ms);
  const Belief before = robot.manager().knowledge().beliefs[StrategyId(0)];
  robot.tell(HearingLost{"nothing came back"});
  robot.fail("lidar", "deaf", 60s);
  EXPECT_EQ(robot.count("did not"), 0u);
  robot["lidar"].fault = "";
  robot.tell(HearingRegained{}, 10s);
  EXPECT_TRUE(robot.works("camera"));
  EXPECT_EQ(robot.count("CameraSilent"), 3u);
  const Belief after = robot.manager().knowledge().beliefs[StrategyId(0)];
  EXPECT_EQ(after.alpha, before.alpha) << "its outcome proves nothing";
  EXPECT_EQ(after.beta, before.beta);
}

// The strategy helped, and culprit slept over the proof: until the camera would have been received
// again, the silence from before proves nothing.
TEST(Hearing, AVerdictWaitsUntilTheRobotWouldHaveBeenReceivedAgain) {
  TestRobot robot = test::robot();
  robot["camera"].fault = "redeploy";
  while (!robot.works("camera")) robot.run_for(50ms);
  robot.tell(HearingLost{"nothing came back"});
  robot["camera"].fault = "deaf";  // as culprit sees it
  robot.run_for(1s);
  robot.tell(HearingRegained{});
  robot.run_for(2100ms);  // later than the strategy's deadline, and in time for the first sample
  EXPECT_EQ(robot.count("did not help"), 0u);
  robot["camera"].fault = "";
  robot.run_for(10s);
  EXPECT_EQ(robot.count("did not help"), 0u);
  EXPECT_EQ(robot.count("redeploy camera: done"), 1u);
}

// The robot may have begun to drive while culprit received nothing.
TEST(Hearing, AnInterlockCountsOnlyByAValueThatCameAfterwards) {
  for (const bool is_read_again : {true, false}) {
    TestRobot robot("INTERLOCK speed < 0.1\n" + std::string(kHearingRules));
    robot.add("camera", {}, "/rgb");
    robot.add("lidar", {}, "/scan");
    robot.discover();
    robot.signal("speed", Value(0.0), 3s);
    robot.tell(HearingLost{"nothing came back"});
    robot.kill("lidar", 1s);
    robot.tell(HearingRegained{}, 1500ms);
    EXPECT_TRUE(robot.asked.empty());
    EXPECT_EQ(robot.count("INTERLOCK speed < 0.1 was true before culprit missed messages"), 1u);
    if (is_read_again) robot.signal("speed", Value(1.5));
    robot.run_for(20s);
    EXPECT_EQ(robot.was_asked("lidar: start process"), !is_read_again);
  }
}

// The age of a topic begins anew after a gap, which is no sign that it still comes.
TEST(Hearing, AnInterlockOnATopicCountsOnlyByASampleThatCameAfterwards) {
  TestRobot robot("INTERLOCK age(/estop) < 1s\n" + std::string(kHearingRules));
  robot.add("camera", {}, "/rgb");
  robot.add("lidar", {}, "/scan");
  robot.add("estop", {}, "/estop");
  robot.discover(3s);
  robot.tell(HearingLost{"nothing came back"});
  robot.kill("lidar");
  robot["estop"].fault = "deaf";  // as culprit sees it
  robot.run_for(1s);
  robot.tell(HearingRegained{}, 20s);
  EXPECT_TRUE(robot.asked.empty());
  EXPECT_EQ(robot.count("INTERLOCK age(/estop) < 1s was true before"), 1u);
}

TEST(Hearing, NothingIsRunByHandWhileDeaf) {
  TestRobot robot = test::robot();
  robot.tell(HearingLost{"nothing came back"});
  robot.order({1, "ada", "", RunStrategy{StrategyId(0)}}, 1s);
  EXPECT_EQ(robot.count("receives nothing from the robot"), 1u);
  EXPECT_TRUE(robot.asked.empty());
}

// A robot whose computer stands still in the middle of a wait.
class SleepyRobot : public Robot {
 public:
  Time now() const override { return now_; }
  void observe(Time until, std::vector<Observation>& observations) override {
    now_ = std::min(until, later(now_, 100ms));
    if (now_ >= Time(5s) && !std::exchange(has_slept_, true)) now_ += 20s;
    observations.push_back({now_, SampleArrived{TopicId(0), 1}});
  }
  void execute(const Command&) override {}

 private:
  Time now_{};
  bool has_slept_ = false;
};

class InterruptedRobot : public Robot {
 public:
  Time now() const override { return {}; }
  void observe(Time, std::vector<Observation>&) override {}
  void execute(const Command&) override {}
  void interrupt() override { ++interrupts; }
  int interrupts = 0;
};

// Else it would wait until something happens to the robot.
TEST(Runtime, AnOrderInterruptsItsWait) {
  const Checked checked = check(Source("test.rules", kHearingRules));
  Manager manager(*checked.rules, std::make_unique<BayesPlanner>(), {});
  InterruptedRobot robot;
  Runtime runtime(manager, robot);
  runtime.submit({1, "ada", "", Pause{}});
  EXPECT_EQ(robot.interrupts, 1);
}

TEST(Runtime, TellsTheManagerThatItOverslept) {
  const Checked checked = check(Source("test.rules", kHearingRules));
  Manager manager(*checked.rules, std::make_unique<BayesPlanner>(), {});
  SleepyRobot robot;
  Runtime runtime(manager, robot);
  std::vector<Duration> slept;
  runtime.on_step = [&](const Runtime::Step& step) {
    for (const Observation& each : step.observations) {
      if (const auto* overslept = std::get_if<Overslept>(&each.what))
        slept.push_back(overslept->by);
    }
  };
  const std::atomic<bool> stop = false;
  runtime.run(stop, Time(40s));
  ASSERT_EQ(slept.size(), 1u);
  EXPECT_GT(slept[0], 19s);
  EXPECT_LE(slept[0], 20s);
}

}  // namespace
}  // namespace culprit::test
