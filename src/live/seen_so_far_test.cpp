// Knowledge of an advising culprit about the robot when it becomes the manager.
#include "live/seen_so_far.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "knowledge/describe.h"
#include "language/checker.h"
#include "manager/manager.h"
#include "plan/bayes/bayes_planner.h"

namespace culprit::live {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using namespace std::chrono_literals;

constexpr Time kStart{1h};

RuleSet watching_rules() {
  return *check(Source("t", R"(COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion LAUNCH "fusion"
SIGNAL entropy DIAGNOSTIC segmentation KEY entropy
RULE CameraGone
  POLICIES ERROR
  TRIGGER alive(camera) == false
    STRATEGY redeploy_camera 90 10
      ADAPTATION camera redeploy 5
RULE Silent
  POLICIES ERROR
  TRIGGER age(/fused) > 2s || entropy > 1
    STRATEGY redeploy_fusion 90 10
      ADAPTATION fusion redeploy 5
)"))
              .rules;
}

// A robot that is seen from kStart on, in virtual time.
struct AfterRestart : testing::Test {
  template <class What>
  void sees(Time at, What what) {
    const std::vector<Observation> one{{at, std::move(what)}};
    seen.note(one);
  }
  // Both nodes, half a second after the start.
  void sees_robot() {
    for (const char* node : {"/camera", "/fusion"}) sees(kStart + 500ms, NodeAppeared{node, 7});
    sees(kStart + 500ms, EndpointAppeared{"/fusion", EndpointKind::kPublisher, "/fused"});
  }
  // The events and commands of a manager that takes over at `now`.
  std::vector<std::string> said_at(Time now) {
    Manager::Options options;
    options.start = std::max(seen.since(), now - options.discovery);
    Manager manager(rules, std::make_unique<BayesPlanner>(), options);
    commands = manager.step(now, seen.observations());
    std::vector<std::string> said;
    for (const Event& event : manager.events())
      said.push_back(seconds_of(event.at - now) + describe(event, rules));
    return said;
  }
  static std::string seconds_of(Duration time) {
    return "[" +
           std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(time).count()) +
           " ms] ";
  }

  const RuleSet rules = watching_rules();
  SeenSoFar seen{rules, kStart};
  std::vector<Command> commands;
};

TEST_F(AfterRestart, NothingIsMissedThatWasThereAllTheTime) {
  sees_robot();
  for (Duration at = 600ms; at < 1min; at += 100ms) sees(kStart + at, SampleArrived{TopicId(0), 1});
  const auto said = said_at(kStart + 1min);
  EXPECT_THAT(commands, IsEmpty());
  EXPECT_THAT(said, Not(Contains(HasSubstr("CameraGone"))));
  EXPECT_THAT(said, Not(Contains(HasSubstr("Silent"))));
}

TEST_F(AfterRestart, WhatDiedMeanwhileIsKnownToBeDeadAndHealedAtOnce) {
  sees_robot();
  for (Duration at = 600ms; at < 59s; at += 100ms) sees(kStart + at, SampleArrived{TopicId(0), 1});
  sees(kStart + 59s,
       ProcessSeen{ComponentId(0), ProcessState::kGone, 7, "killed by signal 9", Cause::kFault});
  sees(kStart + 59s, NodeVanished{"/camera"});
  const auto said = said_at(kStart + 1min);
  EXPECT_THAT(said, Contains(HasSubstr("[-1000 ms] CameraGone"))) << "as of when it died";
  EXPECT_THAT(commands, Not(IsEmpty()));
}

TEST_F(AfterRestart, ASilenceGoesOnWhereItWas) {
  sees_robot();
  sees(kStart + 50s, SampleArrived{TopicId(0), 1});
  EXPECT_THAT(said_at(kStart + 51s), Not(Contains(HasSubstr("Silent"))));
  EXPECT_THAT(said_at(kStart + 53s), Contains(HasSubstr("Silent")));
}

TEST_F(AfterRestart, NoSilenceIsOlderThanTheLastTimeThatNobodyListened) {
  sees_robot();
  sees(kStart + 40s, SampleArrived{TopicId(0), 1});
  sees(kStart + 45s, HearingLost{"no datagrams"});
  sees(kStart + 59s, HearingRegained{});
  EXPECT_EQ(seen.since(), kStart + 59s);
  EXPECT_THAT(said_at(kStart + 1min), Not(Contains(HasSubstr("Silent"))));
  EXPECT_THAT(commands, IsEmpty());
}

TEST_F(AfterRestart, ADeafComponentStaysDeaf) {
  sees_robot();
  sees(kStart + 40s, NodeVanished{"/camera"});
  sees(kStart + 45s, HearingLost{"no datagrams"});
  EXPECT_THAT(said_at(kStart + 1min), Contains(HasSubstr("no datagrams")));
  EXPECT_THAT(commands, IsEmpty());
}

TEST_F(AfterRestart, WhatCameBackIsThere) {
  sees_robot();
  for (Duration at = 600ms; at < 57s; at += 100ms) sees(kStart + at, SampleArrived{TopicId(0), 1});
  sees(kStart + 57s, NodeVanished{"/camera"});
  sees(kStart + 58s, NodeAppeared{"/camera", 8});
  sees(kStart + 58s, EndpointAppeared{"/camera", EndpointKind::kPublisher, "/rgb"});
  sees(kStart + 59s, SampleArrived{TopicId(0), 1});
  const auto said = said_at(kStart + 1min);
  EXPECT_THAT(said, Not(Contains(HasSubstr("CameraGone"))));
  EXPECT_THAT(commands, IsEmpty());
}

// Its lease may say for long that it is there.
TEST_F(AfterRestart, ANodeThatDidNotAnswerOnAnotherComputerIsKnownToBeMissing) {
  sees(kStart, NodeAppeared{"/camera", 0});
  sees(kStart + 500ms, Probed{ComponentId(0), true});
  for (int i = 1; i <= 3; ++i) sees(kStart + 50s + i * 400ms, Probed{ComponentId(0), false});
  EXPECT_THAT(said_at(kStart + 1min), Contains(HasSubstr("CameraGone")));
  sees(kStart + 61s, Probed{ComponentId(0), true});
  EXPECT_THAT(said_at(kStart + 62s), Not(Contains(HasSubstr("CameraGone"))));
  for (int i = 1; i <= 3; ++i) sees(kStart + 62s + i * 400ms, Probed{ComponentId(0), false});
  sees(kStart + 64s, Overslept{2s});
  EXPECT_THAT(said_at(kStart + 65s), Not(Contains(HasSubstr("CameraGone"))));
}

TEST_F(AfterRestart, OfWhatIsReadAgainAndAgainTheLatestCounts) {
  sees_robot();
  for (int i = 0; i < 1000; ++i) {
    sees(kStart + i * 1ms, SampleArrived{TopicId(0), 3});
    sees(kStart + i * 1ms, SignalRead{SignalId(0), Value(0.001 * i)});
  }
  int samples = 0;
  for (const Observation& each : seen.observations()) {
    const auto* sample = std::get_if<SampleArrived>(&each.what);
    if (sample == nullptr) continue;
    ++samples;
    EXPECT_EQ(sample->published, 1u);
    EXPECT_EQ(each.at, kStart + 999ms);
  }
  EXPECT_EQ(samples, 1);
}

TEST_F(AfterRestart, PassersByAreForgottenAndAFloodIsNotKept) {
  for (int i = 0; i < 100; ++i) {
    const std::string node = "/_ros2cli_" + std::to_string(i);
    sees(kStart + i * 1s, NodeAppeared{node, 0});
    sees(kStart + i * 1s, EndpointAppeared{node, EndpointKind::kClient, "/x"});
    sees(kStart + i * 1s, NodeVanished{node});
  }
  EXPECT_THAT(seen.observations(), IsEmpty());
  for (std::size_t i = 0; i <= SeenSoFar::kMost; ++i)
    sees(kStart, NodeAppeared{"/flood" + std::to_string(i), 0});
  EXPECT_FALSE(seen.is_whole());
  EXPECT_THAT(seen.observations(), IsEmpty());
}

}  // namespace
}  // namespace culprit::live
