// State that must survive a crash: spent budgets, earlier attempts, and people's orders.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "replay/test_life.h"

namespace culprit::replay {
namespace {

using culprit::test::TestFolder;
using culprit::test::TestRobot;
using test::Life;
using test::value_of;
using namespace std::chrono_literals;

constexpr const char* kRules = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Silent
  POLICIES ERROR ATTEMPTS 4
  TRIGGER age(/rgb) > 300ms
    STRATEGY restart 90 10
      ADAPTATION camera restart 2
    STRATEGY redeploy 50 10
      ADAPTATION camera redeploy 2
)";
constexpr ComponentId kCamera(0);
constexpr StrategyId kRestart(0);

struct Memory : testing::Test {
  Memory() {
    robot.add("camera", {}, "/rgb");
    live();
    robot.discover(5s);
  }

  // The process ends without a word, with all that it had written; another one takes over.
  void crash() {
    life.reset();
    robot.said.clear();
    robot.events.clear();
    live();
  }
  void live() { life = std::make_unique<Life>(folder / "a.journal", robot, kRules, governor); }
  void run_until_said(const std::string& text) {
    for (int i = 0; i < 6000 && robot.count(text) == 0; ++i) robot.run_for(10ms);
    ASSERT_GT(robot.count(text), 0u) << transcript();
  }
  std::string transcript() const {
    std::string text = "\n";
    for (const std::string& line : robot.said) text += line + "\n";
    return text;
  }
  // Orders of people that still hold.
  std::ptrdiff_t orders() const {
    const History& past = life->recovery.past;
    return std::count_if(past.begin(), past.end(), [](const Event& event) {
      return std::holds_alternative<OrderAccepted>(event.what);
    });
  }
  std::vector<Time> choices() const {
    std::vector<Time> times;
    for (const Event& event : robot.events) {
      if (std::holds_alternative<StrategyChosen>(event.what)) times.push_back(event.at);
    }
    return times;
  }

  const TestFolder folder;
  TestRobot robot{kRules};
  Governor::Options governor;
  std::unique_ptr<Life> life;
};

TEST_F(Memory, OfWhatWasTriedGoesOnWithTheNextStrategy) {
  robot["camera"].fault = "redeploy";
  run_until_said("restart did not resolve Silent");
  crash();
  robot.run_for(20s);
  EXPECT_TRUE(robot.works("camera")) << transcript();
  for (const Event& event : robot.events) {
    const auto* chosen = std::get_if<StrategyChosen>(&event.what);
    EXPECT_FALSE(chosen != nullptr && chosen->strategy == kRestart) << transcript();
  }
}

TEST_F(Memory, OfAttemptsExhaustsTheRuleAsIfNothingHadHappened) {
  robot["camera"].fault = "a person";
  run_until_said("redeploy did not resolve Silent");
  crash();
  run_until_said("exhausted");
  EXPECT_LE(choices().size(), 2u) << "four attempts in all" << transcript();
  crash();
  robot.run_for(30s);
  EXPECT_EQ(choices().size(), 0u) << "a person must look" << transcript();
  EXPECT_EQ(robot.count("exhausted"), 1u) << "and is told again" << transcript();
}

TEST_F(Memory, OfAFailureThatIsGoneIsNone) {
  robot["camera"].fault = "a person";
  run_until_said("exhausted");
  robot["camera"].fault = "";
  crash();
  robot.run_for(5s);
  EXPECT_EQ(robot.count("Silent cleared"), 1u) << "and that is said" << transcript();
  robot["camera"].fault = "a person";
  run_until_said("Silent detected");
  crash();
  robot.fail("camera", "restart", 20s);
  EXPECT_TRUE(robot.works("camera")) << transcript();
}

struct MemoryOfBudgets : Memory {
  MemoryOfBudgets() {
    governor.limits.per_component = {2, 60s};
    crash();
    robot.run_for(3s);
  }
};

TEST_F(MemoryOfBudgets, OutlivesTwoCrashes) {
  robot["camera"].fault = "a person";
  run_until_said("redeploy did not resolve Silent");
  const Time first = choices().front();
  crash();
  robot.run_for(5s);
  crash();
  while (robot.now < first + 59s) robot.run_for(100ms);
  EXPECT_EQ(choices().size(), 0u) << transcript();
  EXPECT_GE(robot.count("2 strategies were begun at camera in 1min"), 1u) << transcript();
  robot.run_for(10s);
  EXPECT_GE(choices().size(), 1u) << transcript();
}

struct MemoryOfBackoff : Memory {
  MemoryOfBackoff() {
    governor.limits.backoff = {10s, 60s, 30s};
    crash();
    robot.run_for(3s);
  }
};

TEST_F(MemoryOfBackoff, GoesOnDoubling) {
  robot["camera"].fault = "a person";
  for (int i = 0; i < 6000 && choices().size() < 2; ++i) robot.run_for(10ms);
  const Time second = choices().back();
  run_until_said("redeploy did not resolve Silent");
  crash();
  for (int i = 0; i < 6000 && choices().empty(); ++i) robot.run_for(10ms);
  ASSERT_FALSE(choices().empty()) << transcript();
  EXPECT_GE(choices().front() - second, 20s) << transcript();
}

TEST_F(Memory, OfSilencesLastsAsLongAsThey) {
  robot.order({1, "Ann", "I am at it", Silence{kCamera, 60s}});
  const Time end = robot.now + 60s;
  robot["camera"].fault = "restart";
  crash();
  robot.run_for(5s);
  crash();
  EXPECT_EQ(orders(), 1);
  while (robot.now < end - 1s) robot.run_for(100ms);
  EXPECT_EQ(choices().size(), 0u) << transcript();
  EXPECT_GE(robot.count("camera is muted by Ann: I am at it"), 1u) << transcript();
  robot.run_for(20s);
  EXPECT_TRUE(robot.works("camera")) << transcript();
}

TEST_F(Memory, OfASilenceThatWasLiftedIsNone) {
  robot.order({1, "Ann", "", Silence{kCamera, {}}});
  robot.order({2, "Ann", "", LiftSilence{kCamera}});
  crash();
  EXPECT_EQ(orders(), 0);
}

TEST_F(Memory, OfOrdersOutlivesARunThatDiedBeforeItsFirstStep) {
  robot.order({1, "Ann", "", Pause{}});
  robot.order({2, "Ann", "", SetDryRun{true}});
  crash();
  crash();
  EXPECT_TRUE(life->recovery.is_paused);
  EXPECT_TRUE(life->recovery.is_dry_run);
}

// It starts inactive, and the culprit that knew it active is gone, as is the one after that.
TEST_F(Memory, OfLifecyclesBringsBackWhatDiedMeanwhile) {
  robot["camera"].state_at_start = Lifecycle::kInactive;
  robot["camera"].process = ProcessState::kGone;
  crash();
  robot.run_for(1s);
  crash();
  robot.run_for(10s);
  EXPECT_TRUE(robot.works("camera")) << transcript();
  EXPECT_EQ(choices().size(), 1u) << transcript();
}

TEST_F(Memory, OfLifecyclesGivesWayToWhatIsSeen) {
  robot["camera"].state = Lifecycle::kInactive;  // somebody wants that
  crash();
  robot.run_for(100ms);
  EXPECT_EQ(robot.manager().knowledge().components[kCamera].intended_lifecycle,
            Lifecycle::kInactive);
}

TEST_F(Memory, ReplaysWithTheRun) {
  robot["camera"].fault = "redeploy";
  run_until_said("restart did not resolve Silent");
  crash();
  robot.run_for(20s);
  life.reset();
  const journal::Reader reader = value_of(journal::Reader::open(folder / "a.journal"));
  Recording recording = value_of(Recording::open(reader));
  const auto again = value_of(repeat(recording, reader, std::make_unique<BayesPlanner>(), {}));
  EXPECT_FALSE(again.difference);
  EXPECT_GE(again.decisions, 3u);
}

TEST_F(Memory, OfWhatWasSeenIsOfOneDomain) {
  run_until_said("camera is there");
  robot["camera"].fault = "redeploy";
  run_until_said("Silent detected");
  life.reset();
  const journal::Reader reader = value_of(journal::Reader::open(folder / "a.journal"));
  journal::Moment now = test::moment(robot);
  const auto here = value_of(journal::recover(reader, {}, robot.rules(), now));
  ASSERT_EQ(here.known_robot.parts.size(), 1u);
  EXPECT_EQ(here.known_robot.parts[0].node, "/camera");
  EXPECT_EQ(here.known_robot.topics, std::vector<std::string>{"/rgb"});
  EXPECT_FALSE(here.is_other_robot());
  EXPECT_FALSE(here.past.empty());
  now.domain = 7;
  const auto elsewhere = value_of(journal::recover(reader, {}, robot.rules(), now));
  EXPECT_EQ(elsewhere.known_robot, KnownRobot());
  EXPECT_TRUE(elsewhere.is_other_robot());
  EXPECT_TRUE(elsewhere.past.empty());
}

// The robot's clock began anew with the machine: at 5 s of it, a silence of 60 s is 20 s old.
TEST(MemoryAfterARestartOfTheMachine, KeepsSilencesOnly) {
  const TestRobot robot(kRules);
  const Time then(1000s);
  const History past = {
      {then, OrderAccepted{{1, "Ann", "", Silence{kCamera, 60s}}}},
      {then, StrategyChosen{StrategyId(0), {}, {}, false}},
      {then, FailureDetected{RuleId(0)}},
  };
  const History after = journal::of_people(past, Time(5s) - 20s - then);
  ASSERT_EQ(after.size(), 1u);
  EXPECT_EQ(after[0].at, Time(-15s));
  EXPECT_EQ(journal::still_counting(after, Time(44s), robot.rules()).size(), 1u);
  EXPECT_EQ(journal::still_counting(after, Time(46s), robot.rules()).size(), 0u);
}

}  // namespace
}  // namespace culprit::replay
