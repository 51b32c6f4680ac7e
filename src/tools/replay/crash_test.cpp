// Culprit is killed after each of its steps that matters, once each, with its last requests sent or
// not, and with its journal written or behind. Another process takes over with nothing but the journal: the robot must end healthy, nothing
// may be asked for twice that does harm then, and what was learned must be the sum of the outcomes
// on record.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "replay/test_life.h"

namespace culprit::replay {
namespace {

namespace fs = std::filesystem;
using culprit::test::TestFolder;
using culprit::test::TestRobot;
using test::Life;
using test::moment;
using test::value_of;
using namespace std::chrono_literals;

struct Story {
  const char* name;
  const char* rules;
  const char* fault;  // of the camera
};

// No more processes than one: each start follows a proven end.
void expect_no_twins(const TestRobot& robot, const std::string& what) {
  EXPECT_LE(robot.count_asked("start process"), robot.count_asked("stop process") + 1) << what;
}

void expect_beliefs_as_recorded(const fs::path& path, const std::string& what) {
  const journal::Reader reader = value_of(journal::Reader::open(path));
  int helped = 0;
  auto rows = value_of(reader.entries(journal::Which::kReadable));
  journal::Entry entry;
  double alpha = 10 * 0.5;
  for (auto more = rows.next(entry); more && *more; more = rows.next(entry)) {
    if (entry.kind != journal::kind::kBelief) continue;
    const auto body = parse_json(entry.body);
    helped += journal::number_of(body, "alpha") > alpha ? 1 : 0;
    alpha = std::max(alpha, journal::number_of(body, "alpha"));
  }
  const auto learned = value_of(reader.learned());
  for (const auto& each : learned.beliefs)
    EXPECT_DOUBLE_EQ(each.belief.alpha - each.prior.alpha, helped) << what;
  EXPECT_LE(helped, 1) << what << ": one failure can be cured once only";
}

// Gives false if the story ended before it could die.
bool live_die_and_go_on(const Story& story, int steps, bool sends, Life::Journal journal,
                        int& behind) {
  const std::string what = std::string(story.name) + " killed after " + std::to_string(steps) +
                           " steps, its requests " + (sends ? "sent" : "not sent") +
                           (journal == Life::Journal::kBehind ? ", its journal behind" : "");
  const TestFolder folder;
  TestRobot robot(story.rules);
  robot.add("camera", {}, "/rgb").parameters["gain"] = 1.0;
  Life first(folder / "first.journal", robot, story.rules);
  robot.discover(6s);
  first.wait_until_known();
  robot["camera"].fault = story.fault;
  first.die_after(steps, sends, journal);
  for (int i = 0; i < 3000 && !first.is_dead(); ++i) robot.run_for(10ms);
  if (!first.is_dead()) return false;
  behind += first.is_behind() ? 1 : 0;

  robot.run_for(1500ms);  // nobody manages it
  Life second(first.remains(), robot, story.rules);
  robot.run_for(90s);
  EXPECT_TRUE(robot.works("camera")) << what;
  EXPECT_EQ(robot.count("exhausted"), 0u) << what;
  expect_no_twins(robot, what);
  expect_beliefs_as_recorded(first.remains(), what);
  return true;
}

class Crash : public testing::TestWithParam<Story> {};

TEST_P(Crash, AfterAnyStepLeavesNothingHalfDone) {
  int deaths = 0;
  int behind = 0;
  const auto lives = [&behind](int steps, bool sends, Life::Journal journal) {
    return live_die_and_go_on(GetParam(), steps, sends, journal, behind);
  };
  for (int steps = 0; lives(steps, true, Life::Journal::kHasIt) && steps < 60; ++steps) {
    lives(steps, false, Life::Journal::kHasIt);
    lives(steps, true, Life::Journal::kBehind);
    lives(steps, false, Life::Journal::kBehind);
    ++deaths;
  }
  EXPECT_GE(deaths, 5) << "chosen, asked for, done, resolved";
  EXPECT_EQ(behind > 0, GetParam().name != std::string("increase")) << "that is on the disk first";
}

INSTANTIATE_TEST_SUITE_P(Stories, Crash,
                         testing::Values(Story{"redeploy", R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Silent
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms
    STRATEGY redeploy 50 10
      ADAPTATION camera redeploy 5
)",
                                               "redeploy"},
                                         Story{"restart", R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Silent
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms
    STRATEGY restart 50 10
      ADAPTATION camera restart 5
)",
                                               "restart"},
                                         Story{"increase", R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Silent
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms
    STRATEGY brighten 50 10
      ADAPTATION camera increase_parameter gain 0.5 5
)",
                                               "gain=1.5"}),
                         [](const auto& story) { return std::string(story.param.name); });

constexpr const char* kSlowCamera = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE CameraDead
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 2
)";

// The state that a run interrupted in a redeploy leaves to one that begins `later`.
journal::Recovery left_behind(Duration later, std::optional<journal::Ending> ending,
                              std::optional<int> manager_before = {}) {
  const TestFolder folder;
  TestRobot robot(kSlowCamera);
  robot.add("camera", {}, "/rgb");
  {
    Life first(folder / "first.journal", robot, kSlowCamera);
    robot.discover(6s);
    robot["camera"].fault = "redeploy";
    robot["camera"].start_time = 10s;
    robot.run_for(2s);
    EXPECT_TRUE(robot.was_asked("camera: start process"));
    if (ending) first.end(*ending);
    robot.before_commands = nullptr;
  }
  const journal::Reader reader = value_of(journal::Reader::open(folder / "first.journal"));
  journal::Moment now = moment(robot);
  now.robot += later;
  return value_of(journal::recover(reader, {}, robot.rules(), now, manager_before));
}

bool has_verdict_on_its_strategy(const History& past) {
  return std::any_of(past.begin(), past.end(), [](const Event& event) {
    return std::holds_alternative<OutcomePending>(event.what) ||
           std::holds_alternative<OutcomeCounted>(event.what) ||
           std::holds_alternative<StrategyFailed>(event.what);
  });
}

TEST(Crash, WhatWasCutShortByItIsGoneOnWith) {
  EXPECT_EQ(left_behind(1s, {}).interrupted.size(), 1u);
  EXPECT_EQ(left_behind(1s, journal::Ending::kStopped).interrupted.size(), 1u);
}

// Another culprit manages the robot since.
TEST(Crash, WhatWasCutShortBySteppingBackIsOverAndProvesNothing) {
  const journal::Recovery found = left_behind(1s, journal::Ending::kSteppedBack);
  EXPECT_TRUE(found.interrupted.empty());
  EXPECT_TRUE(found.given_up.empty());
  EXPECT_FALSE(has_verdict_on_its_strategy(found.past));
}

TEST(Crash, WhatWasCutShortLongAgoIsNotTakenUpAgain) {
  EXPECT_EQ(left_behind(30s, {}).interrupted.size(), 1u);
  const journal::Recovery found = left_behind(61s, {});
  EXPECT_TRUE(found.interrupted.empty());
  EXPECT_THAT(found.given_up, testing::ElementsAre("redeploy for CameraDead: that was more than "
                                                   "1min ago, so it is not continued"));
}

// On one machine, with journals of their own or with one for both; or on two machines.
TEST(Crash, WhatWasCutShortBeforeAnotherCulpritManagedIsNotTakenUpAgain) {
  constexpr int kAnother = test::kProcess + 1;
  constexpr int kOnAnotherMachine = 0;
  for (const int manager : {kAnother, kOnAnotherMachine}) {
    const journal::Recovery found = left_behind(1s, {}, manager);
    EXPECT_TRUE(found.interrupted.empty());
    EXPECT_THAT(found.given_up,
                testing::ElementsAre("redeploy for CameraDead: another culprit has "
                                     "managed the robot since, so it is not continued"));
  }
  EXPECT_EQ(left_behind(1s, {}, test::kProcess).interrupted.size(), 1u)
      << "whose journal that is managed until now";
}

TEST(Crash, WhatTheLastRunLeftIsKnown) {
  const TestFolder folder;
  const char* rules = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Silent
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms
    STRATEGY redeploy 50 10
      ADAPTATION camera redeploy 5
)";
  TestRobot robot(rules);
  robot.add("camera", {}, "/rgb");
  Life life(folder / "a.journal", robot, rules);
  robot.discover(6s);
  robot["camera"].fault = "redeploy";
  while (!robot.was_asked("start process")) robot.run_for(10ms);
  life.die_after(0, true);
  while (!life.is_dead()) robot.run_for(10ms);
  const journal::Reader reader = value_of(journal::Reader::open(life.remains()));
  const auto recovery = test::recovered(life.remains(), robot);
  ASSERT_EQ(recovery.interrupted.size(), 1u);
  const Interrupted& interrupted = recovery.interrupted.front();
  ASSERT_EQ(interrupted.requests.size(), 2u) << "stop, start";
  EXPECT_EQ(interrupted.requests[0].outcome, Outcome::kDone);
  EXPECT_TRUE(std::holds_alternative<StartProcess>(interrupted.requests[1].command.what));
  EXPECT_FALSE(recovery.was_stopped);
  EXPECT_FALSE(recovery.was_other_boot);
}

// The picture is measured to be sharp 1.5 s after the camera was replaced.
TEST(Crash, HowLateARuleIsIsKnownToTheNextProcess) {
  const TestFolder folder;
  const char* rules = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Blurred
  POLICIES ERROR
  TRIGGER blur > 0.5
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 15
)";
  TestRobot robot(rules);
  robot.add("camera", {}, "/rgb");
  const auto measure = [&](double blur, Duration time) {
    for (const Time end = robot.now + time; robot.now < end; robot.run_for(100ms))
      robot.signal("blur", Value(blur));
  };
  const auto blur_once = [&] {
    const std::size_t before = robot.count_asked("start process");
    while (robot.count_asked("start process") == before) measure(1, 100ms);
    measure(1, 1500ms);
    measure(0, 5s);
  };
  const auto learned = [&] { return robot.manager().knowledge().latencies.learned(RuleId(0)); };
  Latencies::Learned first;
  {
    const Life life(folder / "a.journal", robot, rules);
    robot.discover();
    measure(0, 6s);
    blur_once();
    first = learned();
    EXPECT_EQ(first.count, 1);
  }
  {
    const Life life(folder / "a.journal", robot, rules);
    EXPECT_EQ(learned(), first);
    measure(0, 2min);
    blur_once();
    EXPECT_EQ(learned().count, 2);
  }
  const journal::Reader reader = value_of(journal::Reader::open(folder / "a.journal"));
  Recording recording = value_of(Recording::open(reader));
  const auto repeated = value_of(repeat(recording, reader, std::make_unique<BayesPlanner>(), {}));
  EXPECT_FALSE(repeated.difference) << "it begins with what the first process had learned";
}

// The picture is bad for some time, and the fusion that reads it works all the while.
TEST(Crash, ThatAFailureDidNotFollowAnotherIsKnownToTheNextProcess) {
  const TestFolder folder;
  const char* rules = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion LAUNCH "fusion"
RULE Blurred
  POLICIES ERROR
  TRIGGER blur > 0.5
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 2
RULE Lost
  POLICIES ERROR
  TRIGGER drift > 0.5
    STRATEGY redeploy_fusion 90 10
      ADAPTATION fusion redeploy 2
)";
  TestRobot robot(rules);
  robot.add("camera", {}, "/rgb");
  robot.add("fusion", {"camera"}, "/fused");
  const auto measure = [&](double blur, Duration time) {
    for (const Time end = robot.now + time; robot.now < end; robot.run_for(100ms)) {
      robot.signal("blur", Value(blur));
      robot.signal("drift", Value(0.0));
    }
  };
  const auto learned = [&] {
    return robot.manager().knowledge().couplings.of(RuleId(0), RuleId(1));
  };
  Life first(folder / "first.journal", robot, rules);
  robot.discover();
  measure(0, 6s);
  measure(1, 20s);
  measure(0, 5s);
  const Coupling known = learned();
  EXPECT_GT(known.spared, 1);
  first.die_after(0, true);
  measure(1, 5s);
  ASSERT_TRUE(first.is_dead());
  {
    const Life second(first.remains(), robot, rules);
    EXPECT_EQ(learned(), known);
    measure(1, 5s);
  }
  const journal::Reader reader = value_of(journal::Reader::open(first.remains()));
  Recording recording = value_of(Recording::open(reader));
  const auto repeated = value_of(repeat(recording, reader, std::make_unique<BayesPlanner>(), {}));
  EXPECT_FALSE(repeated.difference) << "it begins with what the first process had learned";
}

// The camera and the arm, which the graph does not connect, fail at the same moments.
constexpr const char* kSharedPort = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT arm NODE /arm LAUNCH "arm"
COMPONENT lidar NODE /lidar LAUNCH "lidar"
RULE Blurred
  POLICIES ERROR
  TRIGGER blur > 0.5
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 2
RULE Stuck
  POLICIES ERROR
  TRIGGER effort > 0.5
    STRATEGY redeploy_arm 90 10
      ADAPTATION arm redeploy 2
)";

int times_together(const fs::path& path) {
  for (const auto& each : value_of(value_of(journal::Reader::open(path)).learned()).coincidences) {
    if (each.rule == "Blurred" && each.other == "Stuck") return each.count;
  }
  return 0;
}

struct SharedPort : testing::Test {
  void measure(double both, Duration time) {
    for (const Time end = robot.now + time; robot.now < end; robot.run_for(100ms)) {
      robot.signal("blur", Value(both));
      robot.signal("effort", Value(both));
    }
  }
  // The second time is on record, and both failures are there.
  void fail_twice(const fs::path& journal) {
    for (int i = 0; i < 2; ++i) {
      measure(0, 2min);
      measure(1, 3s);
    }
    for (int i = 0; i < 1000 && times_together(journal) < 2; ++i) std::this_thread::sleep_for(10ms);
    EXPECT_EQ(times_together(journal), 2);
  }
  const Coincidences& known() { return robot.manager().knowledge().coincidences; }
  // All of it, by name.
  std::vector<journal::LearnedCoincidence> counts() {
    const RuleSet& rules = robot.manager().knowledge().rules;
    return journal::named(known(), Coincidences(rules), rules);
  }

  const TestFolder folder;
  TestRobot robot{kSharedPort};
};

TEST_F(SharedPort, CountsFollowTheNamesOfTheRules) {
  journal::Learned learned;
  learned.coincidences = {{"Blurred", "Gone", 4}, {"Blurred", "Stuck", 3}, {"Stuck", "Stuck", 5}};
  restore(robot.manager(), learned, robot.rules());
  EXPECT_EQ(known().together(RuleId(1), RuleId(0)), 3);
  EXPECT_EQ(known().times(RuleId(0)), 0);
  EXPECT_EQ(known().times(RuleId(1)), 5);
}

TEST_F(SharedPort, ThatFailuresBeganTogetherIsKnownToTheNextProcess) {
  for (const char* name : {"camera", "arm", "lidar"}) robot.add(name, {}, "/" + std::string(name));
  Life first(folder / "first.journal", robot, kSharedPort);
  robot.discover();
  fail_twice(folder / "first.journal");
  const auto before = counts();
  first.die_after(0, true);
  robot.leave("lidar");
  for (int i = 0; i < 60 && !first.is_dead(); ++i) measure(1, 1s);
  ASSERT_TRUE(first.is_dead());
  {
    const Life second(first.remains(), robot, kSharedPort);
    EXPECT_EQ(counts(), before);
    measure(1, 10s);
    for (const RuleId rule : {RuleId(0), RuleId(1)})
      EXPECT_NE(robot.manager().knowledge().states[rule].phase, RulePhase::kQuiet);
    EXPECT_EQ(counts(), before) << "the next process detects them, but they have not begun again";
  }
  const journal::Reader reader = value_of(journal::Reader::open(first.remains()));
  Recording recording = value_of(Recording::open(reader));
  const auto repeated = value_of(repeat(recording, reader, std::make_unique<BayesPlanner>(), {}));
  EXPECT_FALSE(repeated.difference) << "it begins with what the first process had counted";
}

}  // namespace
}  // namespace culprit::replay
