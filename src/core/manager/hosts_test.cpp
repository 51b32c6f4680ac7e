// An unreachable computer is one cause: culprit does nothing there, failures because of it wait, and
// culprit learns nothing from them.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "manager/test_robot.h"

namespace culprit::test {
namespace {

using testing::HasSubstr;

// Camera and lidar run on rover2; their consumers, and a lamp, on this computer.
constexpr const char* kHostRules = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT lidar  NODE /lidar  LAUNCH "lidar"
COMPONENT fusion NODE /fusion LAUNCH "fusion"
COMPONENT lamp   NODE /lamp   LAUNCH "lamp"
RULE CameraGone
  POLICIES ERROR ATTEMPTS 2
  TRIGGER !alive(camera)
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 10
RULE LidarSilent
  POLICIES ERROR ATTEMPTS 1
  TRIGGER age(/scan) > 500ms
    STRATEGY redeploy 90 10
      ADAPTATION lidar redeploy 10
RULE FusionSilent
  POLICIES WARNING ATTEMPTS 2
  TRIGGER age(/fused) > 500ms
    STRATEGY restart 50 10
      ADAPTATION fusion restart 2
    STRATEGY redeploy 90 10
      ADAPTATION fusion redeploy 10
RULE LampGone
  POLICIES ERROR ATTEMPTS 2
  TRIGGER !alive(lamp)
    STRATEGY redeploy 90 10
      ADAPTATION lamp redeploy 10
)";

struct TwoComputers {
  explicit TwoComputers(const std::string& rules = kHostRules)
      : robot(rules, std::make_unique<BayesPlanner>(), options()) {
    robot.add("camera", {}, "/rgb").host = "rover2";
    robot.add("lidar", {}, "/scan").host = "rover2";
    robot.add("fusion", {"camera"}, "/fused");
    robot.add("lamp");
  }
  static Manager::Options options() {
    Manager::Options options;
    options.governor.limits.backoff.healthy =
        60s;  // as of `culprit run`: so long nothing is learned
    return options;
  }
  void begin() {
    robot.discover(8s);
    EXPECT_EQ(robot.count("detected"), 0u);
    robot.said.clear();
    for (std::size_t s = 0; s < robot.rules().strategies.size(); ++s)
      before.push_back(beliefs()[StrategyId(s)].mean().value);
  }
  const Beliefs& beliefs() { return robot.manager().knowledge().beliefs; }
  RulePhase phase(const std::string& name) {
    for (std::size_t r = 0; r < robot.rules().rules.size(); ++r) {
      if (robot.rules().rules[r].name == name)
        return robot.manager().knowledge().states[RuleId(r)].phase;
    }
    ADD_FAILURE() << name;
    return RulePhase::kQuiet;
  }
  // No belief in the strategies of these rules has changed.
  void expect_nothing_learned(const std::vector<std::string>& of) {
    const RuleSet& rules = robot.rules();
    for (std::size_t s = 0; s < before.size(); ++s) {
      const std::string& rule = rules[rules.strategies[s].rule].name;
      if (std::ranges::find(of, rule) == of.end()) continue;
      EXPECT_EQ(beliefs()[StrategyId(s)].mean().value, before[s])
          << rule << "." << rules.strategies[s].name;
    }
  }

  TestRobot robot;
  std::vector<double> before;
};

TEST(Hosts, ThatAreNotHeardAreOneCauseAndNothingIsDoneThere) {
  TwoComputers two;
  two.begin();
  two.robot.cut("rover2", 5s);
  two.robot.asked.clear();
  two.robot.run_for(300s);
  EXPECT_TRUE(two.robot.asked.empty());
  EXPECT_EQ(two.robot.count("rover2, where camera and lidar ran, is unreachable"), 1u);
  for (const char* rule : {"CameraGone", "LidarSilent", "FusionSilent"})
    EXPECT_EQ(two.phase(rule), RulePhase::kFailing) << rule;
  EXPECT_GE(two.robot.count("CameraGone waits: camera is on rover2, which is unreachable"), 1u);
  EXPECT_EQ(two.robot.count("CameraGone is exhausted"), 0u);
  two.expect_nothing_learned({"CameraGone", "LidarSilent", "FusionSilent"});
}

// Before it is known that the computer is silent, its nodes look ill one by one.
TEST(Hosts, WhatWasTriedBeforeAnybodyKnewIsForgiven) {
  TwoComputers two;
  two.begin();
  two.robot.cut("rover2", 3s);
  EXPECT_EQ(two.phase("LidarSilent"), RulePhase::kExhausted);
  two.robot.run_for(2s);
  EXPECT_EQ(two.phase("LidarSilent"), RulePhase::kFailing);
  two.robot.run_for(120s);
  two.expect_nothing_learned({"LidarSilent"});
}

TEST(Hosts, ThatAreHeardAgainGoOnAsBefore) {
  for (const Duration length : {Duration(8s), Duration(60s)}) {
    TwoComputers two;
    two.begin();
    two.robot.cut("rover2", length);
    two.robot.mend("rover2");
    two.robot.asked.clear();
    two.robot.run_for(3s);
    EXPECT_TRUE(two.robot.asked.empty());
    EXPECT_EQ(two.robot.count("rover2 is reachable again"), 1u);
    for (const char* rule : {"CameraGone", "LidarSilent", "FusionSilent"})
      EXPECT_EQ(two.phase(rule), RulePhase::kQuiet) << rule;
    two.robot.run_for(120s);
    EXPECT_FALSE(two.robot.was_asked("camera:"));
    two.expect_nothing_learned({"CameraGone", "LidarSilent"});
  }
}

// It had the time to be received again.
TEST(Hosts, WhatDidNotComeBackWithItsComputerIsTriedThen) {
  TwoComputers two;
  two.begin();
  two.robot.cut("rover2", 30s);
  two.robot["camera"].process = ProcessState::kGone;
  two.robot.asked.clear();
  two.robot.mend("rover2", 10s);
  EXPECT_FALSE(two.robot.was_asked("camera:"));
  two.robot.run_for(3s);
  EXPECT_TRUE(two.robot.was_asked("camera:"));
}

TEST(Hosts, WhatBreaksHereMeanwhileIsHealed) {
  TwoComputers two;
  two.begin();
  two.robot.cut("rover2", 30s);
  two.robot.kill("lamp");
  two.robot.kill("fusion", 10s);
  EXPECT_TRUE(two.robot.works("lamp"));
  EXPECT_TRUE(two.robot.was_asked("fusion: start"));
}

// A node that is silent while another one of its computer is received has a fault of its own.
TEST(Hosts, AreNotBlamedForOneOfTheirNodes) {
  TwoComputers two;
  two.begin();
  two.robot.fail("lidar", "a person", 30s);
  EXPECT_EQ(two.robot.count("is unreachable"), 0u);
  EXPECT_EQ(two.phase("LidarSilent"), RulePhase::kExhausted);
}

TEST(Hosts, DoNotKeepASafeStopWaiting) {
  TwoComputers two(std::string(kHostRules) + R"(
RULE Blind
  POLICIES ERROR ATTEMPTS 3
  TRIGGER !alive(camera)
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 10
    STRATEGY stop 90 10 LASTRESORT
      ADAPTATION lamp set_parameter red true 1
)");
  two.robot["lamp"].parameters["red"] = Value(false);
  two.begin();
  two.robot.cut("rover2", 10s);
  EXPECT_EQ(two.robot["lamp"].parameters["red"], Value(true));
}

// A person ended it here, and starts it there.
TEST(Hosts, WhatAPersonMovesToAnotherOneStaysDownNoMore) {
  TwoComputers two;
  two.begin();
  const ComponentId lamp = two.robot.id("lamp");
  const Departures& departures = two.robot.manager().knowledge().departures;
  two.robot["lamp"].process = ProcessState::kGone;
  two.robot.tell(ProcessSeen{lamp, ProcessState::kGone, two.robot["lamp"].pid, "killed by signal 2",
                             Cause::kOrder},
                 30s);
  EXPECT_TRUE(departures.stays_down(lamp));
  two.robot["lamp"].host = "rover2";
  two.robot.start_by_hand("lamp", 5s);
  EXPECT_FALSE(departures.stays_down(lamp));
  EXPECT_FALSE(two.robot.was_asked("lamp: start process"));
}

// The next culprit may begin while the computer is out of reach.
TEST(Hosts, AreKnownToTheNextCulpritUntilANodeIsHere) {
  TwoComputers two;
  two.begin();
  const KnownRobot known = two.robot.manager().knowledge().known_robot();
  Manager::Options options = TwoComputers::options();
  options.start = two.robot.now;
  Manager next(two.robot.rules(), std::make_unique<BayesPlanner>(), options);
  next.remember(known);
  const ComponentId camera = two.robot.id("camera");
  const ComponentStates& components = next.knowledge().components;
  EXPECT_EQ(components[camera].host, "rover2");
  EXPECT_EQ(components[two.robot.id("lamp")].host, "");
  EXPECT_EQ(next.knowledge().known_robot().parts.at(camera.index).host, "rover2");
  const Observation here{two.robot.now, NodeAppeared{"/camera", 4711}};
  next.step(two.robot.now, {&here, 1});
  EXPECT_EQ(components[camera].host, "");
}

// It may get round the computer: once, and that it did not help says nothing.
TEST(Hosts, MayBeGotRoundOnce) {
  TwoComputers two(std::string(kHostRules) + R"(
RULE Fused
  POLICIES ERROR ATTEMPTS 2
  TRIGGER age(/fused) > 6s
    STRATEGY other_source 90 10
      ADAPTATION fusion set_parameter source 2 1
)");
  two.robot["fusion"].parameters["source"] = Value(std::int64_t{1});
  two.begin();
  two.robot.cut("rover2", 300s);
  EXPECT_EQ(two.robot.count_asked("fusion: set source to 2"), 1u);
  EXPECT_EQ(two.phase("Fused"), RulePhase::kFailing);
  two.expect_nothing_learned({"Fused"});
}

TEST(Hosts, OfWhichNothingIsKnownAreNotBlamed) {
  TwoComputers two;
  two.begin();
  two.robot.tell(HostHeard{"rovr2", false});
  two.robot.tell(HostHeard{"", false});
  two.robot.fail("fusion", "restart", 30s);
  EXPECT_TRUE(two.robot.works("fusion"));
  EXPECT_EQ(two.robot.count("is unreachable"), 0u);
}

// HOST names a computer that does not exist, and no node was ever seen there.
TEST(Hosts, AMistypedOneExplainsNothing) {
  TestRobot robot(R"(
COMPONENT lidar NODE /lidar UNIT lidar.service HOST rovr2
COMPONENT fusion NODE /fusion LAUNCH "fusion"
DEPENDENCY fusion ON lidar
RULE FusionSilent
  POLICIES ERROR
  TRIGGER age(/fused) > 500ms
    STRATEGY redeploy 90 10
      ADAPTATION fusion redeploy 10
)");
  robot.add("fusion", {}, "/fused");
  robot.discover();
  robot.tell(HostReached{robot.id("lidar"), false}, 8s);
  robot.fail("fusion", "redeploy", 30s);
  EXPECT_TRUE(robot.works("fusion"));
}

TEST(Hosts, AllAtOnceMayBeThisOneThatIsCutOff) {
  TwoComputers two;
  two.robot["lidar"].host = "rover3";
  two.begin();
  two.robot.cut("rover2", 6s);
  EXPECT_EQ(two.robot.count("this one may be cut off"), 0u);
  two.robot.cut("rover3", 6s);
  EXPECT_EQ(two.robot.count("this one may be cut off"), 1u);
  EXPECT_EQ(two.robot.count("rover3, where lidar ran, is unreachable"), 1u);
}

// A deaf culprit, which must not act on the messages that it still receives, reports no silent
// computer either and judges nothing.
TEST(Hosts, AreNotJudgedByOneThatIsDeaf) {
  TwoComputers two;
  two.begin();
  two.robot.tell(HearingLost{"nothing comes back"});
  two.robot.cut("rover2", 3s);
  EXPECT_TRUE(two.robot.asked.empty());
  two.robot.mend("rover2", 2s);
  two.robot.tell(HearingRegained{}, 30s);
  EXPECT_FALSE(two.robot.was_asked("camera:"));
  EXPECT_EQ(two.robot.count("is unreachable"), 0u);
}

// Whenever it is cut, for how long and how often, and whatever dies on this side meanwhile.
RC_GTEST_PROP(Hosts, TeachNothingByTheirSilence, ()) {
  TwoComputers two;
  two.begin();
  bool is_killed = false;  // once: what dies again and again is exhausted by itself
  for (int cuts = *rc::gen::inRange(1, 4); cuts > 0; --cuts) {
    two.robot.run_for(std::chrono::milliseconds(*rc::gen::inRange(0, 20'000)));
    two.robot.cut("rover2");
    const Duration length = std::chrono::milliseconds(*rc::gen::inRange(100, 60'000));
    two.robot.run_for(std::min<Duration>(length, 4500ms));
    if (length > 4500ms) {
      two.robot.asked.clear();
      const bool dies = !is_killed && *rc::gen::arbitrary<bool>();
      is_killed |= dies;
      if (dies) two.robot.kill("lamp");
      two.robot.run_for(length - 4500ms);
      RC_ASSERT(!two.robot.was_asked("camera:"));
      RC_ASSERT(!two.robot.was_asked("lidar:"));
      RC_ASSERT(two.phase("CameraGone") != RulePhase::kExhausted);
      RC_ASSERT(two.phase("LidarSilent") != RulePhase::kExhausted);
      RC_ASSERT(two.phase("FusionSilent") != RulePhase::kExhausted);
    }
    two.robot.mend("rover2", 20s);
    RC_ASSERT(two.robot.works("lamp"));
    RC_ASSERT(two.robot.works("fusion"));
  }
}

}  // namespace
}  // namespace culprit::test
