// The first seconds of a run on a robot that an earlier run knew: its parts are expected, and no
// topic counts as silent before all of them are there.
#include <gtest/gtest.h>

#include "manager/test_robot.h"

namespace culprit::test {
namespace {

constexpr const char* kTwoCameras =
    "COMPONENT left NODE /left LAUNCH \"left\"\n"
    "COMPONENT right NODE /right LAUNCH \"right\"\n"
    "SIGNAL hot DIAGNOSTIC motor KEY hot\n"
    "RULE LeftSilent\nPOLICIES ERROR\nTRIGGER age(/left_image) > 300ms\n"
    "STRATEGY left_redeploy 90 10\nADAPTATION left redeploy 2\n"
    "RULE RightSilent\nPOLICIES ERROR\nTRIGGER rate(/right_image) < 1\n"
    "STRATEGY right_redeploy 90 10\nADAPTATION right redeploy 2\n"
    "RULE Hot\nPOLICIES ERROR\nTRIGGER hot > 90\n"
    "STRATEGY right_restart 90 10\nADAPTATION right restart 2\n";

// Two cameras, of which the left one falls silent while its process runs on; culprit is killed then,
// and another one begins. The test decides which messages that one receives.
struct KnownStart : testing::Test {
  KnownStart() {
    for (const char* name : {"left", "right"}) robot.add(name);
  }
  static KnownRobot known() {
    KnownRobot robot;
    robot.parts = {{"left", "/left", {{EndpointKind::kPublisher, "/left_image"}}, 11},
                   {"right", "/right", {{EndpointKind::kPublisher, "/right_image"}}, 12}};
    robot.topics = robot.heard = {"/left_image", "/right_image"};
    robot.read = {"signal hot"};
    robot.is_whole = true;
    return robot;
  }

  void begin(const KnownRobot& earlier) { robot.manager().remember(earlier); }
  // All that an earlier run knew shows up, and the left one is known to be listened to.
  void begin_whole(const KnownRobot& earlier = known()) {
    begin(earlier);
    show_both();
    hear_the_rest();
  }
  void hear_the_rest() {
    read_motor();
    know_listener("/left_image");
  }
  void show(const std::string& name, int pid) {
    robot.tell(NodeAppeared{"/" + name, pid});
    robot.tell(EndpointAppeared{"/" + name, EndpointKind::kPublisher, "/" + name + "_image"});
  }
  void show_both() {
    show("left", 11);
    show("right", 12);
  }
  void read_motor() { robot.signal("hot", Value(20.0)); }
  void know_listener(const std::string& topic) {
    for (std::size_t t = 0; t < robot.rules().topics.size(); ++t) {
      if (robot.rules().topics[t].name == topic) robot.tell(ListenerKnown{TopicId(t)});
    }
  }
  // The right one publishes.
  void run_for(Duration time) {
    for (Time end = robot.now + time; robot.now < end;) {
      robot.run_for(100ms);
      if (right_speaks) robot.tell(SampleArrived{right_image(), 1});
    }
  }
  TopicId right_image() const {
    return TopicId(robot.rules().topics[0].name == "/right_image" ? 0u : 1u);
  }
  std::size_t detected() const { return robot.count("LeftSilent detected"); }
  // Not before the time of discovery, and then.
  void expect_full_wait() {
    run_for(4800ms - (robot.now - Time()));
    EXPECT_EQ(detected(), 0u);
    EXPECT_TRUE(robot.asked.empty());
    run_for(1s);
    EXPECT_EQ(detected(), 1u);
  }

  TestRobot robot{kTwoCameras};
  bool right_speaks = true;
};

TEST_F(KnownStart, WhatIsSilentAmongAllThatWasExpectedIsJudgedAtOnce) {
  begin(known());
  show_both();
  read_motor();
  run_for(200ms);
  know_listener("/left_image");
  run_for(200ms);
  EXPECT_EQ(detected(), 0u) << "it has been listened to for 200 ms";
  run_for(200ms);
  EXPECT_EQ(detected(), 1u);
  EXPECT_LT(robot.now - Time(), 1s);
}

TEST_F(KnownStart, ARateIsKnownOnceItWasListenedToForAWholeWindow) {
  right_speaks = false;
  begin_whole();
  know_listener("/right_image");
  run_for(900ms);
  EXPECT_EQ(robot.count("RightSilent detected"), 0u);
  run_for(2s);
  EXPECT_EQ(robot.count("RightSilent detected"), 1u);
}

TEST_F(KnownStart, WhatSpeaksInTimeIsNotSilent) {
  begin_whole();
  for (int i = 0; i < 60; ++i) {
    run_for(100ms);
    robot.tell(SampleArrived{TopicId(1u - right_image().index), 1});
  }
  EXPECT_EQ(detected(), 0u);
}

// It may not know its subscriber yet, and publish all the time.
TEST_F(KnownStart, ANodeThatHasNotDiscoveredItsListenerMaySendUnreceived) {
  begin(known());
  show_both();
  read_motor();
  expect_full_wait();
}

TEST_F(KnownStart, WhileAnythingIsMissingAllSilenceWaits) {
  begin(known());
  show("left", 11);
  hear_the_rest();
  right_speaks = false;  // it is discovered late, or died: that is unknown
  expect_full_wait();
}

TEST_F(KnownStart, ATopicThatIsMissingAndUnprovenMayBeTheCause) {
  begin_whole();
  right_speaks = false;
  expect_full_wait();
}

TEST_F(KnownStart, AValueThatTheLastRunReadIsWaitedFor) {
  begin(known());
  show_both();
  know_listener("/left_image");
  expect_full_wait();
}

TEST_F(KnownStart, AnEndThatIsMissingIsWaitedFor) {
  KnownRobot earlier = known();
  earlier.parts[1].ends.push_back({EndpointKind::kSubscriber, "/left_image"});
  begin_whole(earlier);
  expect_full_wait();
}

// It was started again since, and may have to open its device first.
TEST_F(KnownStart, AnotherProcessHasTheTimeOfAnyOther) {
  begin(known());
  show("left", 99);
  show("right", 12);
  hear_the_rest();
  expect_full_wait();
}

TEST_F(KnownStart, AProcessOfWhichNothingIsKnownHasTheTimeOfAnyOther) {
  KnownRobot earlier = known();
  earlier.parts[0].pid = 0;
  begin(earlier);
  show("left", 0);
  show("right", 12);
  hear_the_rest();
  expect_full_wait();
}

TEST_F(KnownStart, WhatTheLastRunNeverHeardHasTheTimeOfAnyOther) {
  KnownRobot earlier = known();
  earlier.heard = {"/right_image"};
  begin_whole(earlier);
  expect_full_wait();
}

// It saw only a part: it was killed in its own first seconds.
TEST_F(KnownStart, ARunThatDidNotSeeTheRobotWholeExpectsNothing) {
  KnownRobot earlier = known();
  earlier.is_whole = false;
  begin_whole(earlier);
  expect_full_wait();
}

TEST_F(KnownStart, AnotherPublisherMaySpeakInItsPlace) {
  begin(known());
  show_both();
  robot.tell(NodeAppeared{"/spare", 50});
  robot.tell(EndpointAppeared{"/spare", EndpointKind::kPublisher, "/left_image"});
  hear_the_rest();
  expect_full_wait();
}

TEST_F(KnownStart, TwoOfOneNameAreNotWhatWasExpected) {
  begin(known());
  show_both();
  robot.tell(NamesakesSeen{"/right", 1});
  hear_the_rest();
  expect_full_wait();
}

TEST_F(KnownStart, ANodeThatLeavesMeanwhileIsNotExpected) {
  begin(known());
  show_both();
  robot.tell(NodeVanished{"/right"});
  show("right", 12);
  hear_the_rest();
  expect_full_wait();
}

TEST_F(KnownStart, AMomentOfDeafnessEndsAllExpectations) {
  begin(known());
  show_both();
  robot.tell(HearingLost{"a test"});
  robot.tell(HearingRegained{});
  hear_the_rest();
  run_for(2s);
  EXPECT_EQ(detected(), 0u);
}

TEST_F(KnownStart, ASleepAtTheBeginningExpectsNothing) {
  begin(known());
  show_both();
  robot.tell(Overslept{2s});
  hear_the_rest();
  run_for(2s);
  EXPECT_EQ(detected(), 0u);
}

// A component that a person starts anew in the moment of the verdict gets its grace period.
TEST_F(KnownStart, ANodeStartedAgainAfterwardsHasItsTime) {
  begin_whole();
  run_for(200ms);
  robot.tell(NodeVanished{"/left"});
  show("left", 77);
  run_for(2s);
  EXPECT_EQ(detected(), 0u);
  EXPECT_TRUE(robot.asked.empty());
}

TEST_F(KnownStart, WhatWasNeverSeenWaitsAsEver) {
  KnownRobot earlier = known();
  earlier.parts.pop_back();
  earlier.topics = earlier.heard = {"/left_image"};
  begin(earlier);
  show("left", 11);
  hear_the_rest();
  right_speaks = false;
  run_for(4800ms);
  EXPECT_EQ(robot.count("right was never seen"), 0u);
  run_for(400ms);
  EXPECT_EQ(robot.count("right was never seen"), 1u);
}

// ---- knowledge for the next run

TEST_F(KnownStart, TellsTheNextRunWhatWasReceivedAndFromWhichNode) {
  show_both();
  read_motor();
  run_for(3s);
  EXPECT_FALSE(robot.manager().knowledge().known_robot().is_whole);
  run_for(3s);
  const KnownRobot told = robot.manager().knowledge().known_robot();
  EXPECT_TRUE(told.is_whole);
  EXPECT_EQ(told.heard, std::vector<std::string>{"/right_image"});
  EXPECT_EQ(told.read, std::vector<std::string>{"signal hot"});
  ASSERT_EQ(told.parts.size(), 2u);
  EXPECT_EQ(told.parts[1].pid, 12);
}

// Else the one that came up a moment before culprit was killed would be expected to publish at
// once.
TEST_F(KnownStart, WhatAnotherProcessSaidWasNotHeardOfThisOne) {
  show_both();
  run_for(6s);
  robot.tell(NodeVanished{"/right"});
  show("right", 13);
  EXPECT_TRUE(robot.manager().knowledge().known_robot().heard.empty());
  run_for(200ms);
  EXPECT_EQ(robot.manager().knowledge().known_robot().heard.size(), 1u);
}

TEST_F(KnownStart, AShorterWaitHasNotSeenAll) {
  Manager::Options options;
  options.discovery = 2s;
  TestRobot hasty(kTwoCameras, std::make_unique<BayesPlanner>(), options);
  hasty.tell(NodeAppeared{"/left", 11}, 10s);
  EXPECT_FALSE(hasty.manager().knowledge().known_robot().is_whole);
}

}  // namespace
}  // namespace culprit::test
