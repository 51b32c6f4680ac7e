// A recorded run, once more: exactly, and with other rules.
#include "replay/replay.h"

#include <fstream>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_expected.h"
#include "base/test_folder.h"
#include "journal/recorder.h"
#include "journal/verify.h"
#include "manager/test_robot.h"
#include "replay/hindsight.h"
#include "replay/test_life.h"

namespace culprit::replay {
namespace {

using culprit::test::TestFolder;
using culprit::test::TestRobot;
using culprit::test::value_of;
using test::kWall;
using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr const char* kReplayRules = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion LAUNCH "fusion"
RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms
    STRATEGY restart 50 10
      ADAPTATION camera restart 3
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 10
RULE FusionSilent
  POLICIES WARNING FOR 100ms
  TRIGGER age(/fused) > 400ms
    STRATEGY fusion_redeploy 90 10
      ADAPTATION fusion redeploy 10
)";

// Records what `play` does to a robot of two components.
void record(const std::filesystem::path& path, const std::function<void(TestRobot&)>& play) {
  TestRobot robot(kReplayRules);
  robot.add("camera", {}, "/rgb");
  robot.add("fusion", {"camera"}, "/fused");
  journal::Session session;
  session.rules_path = "test.rules";
  session.rules_text = kReplayRules;
  session.discovery = Manager::kDiscovery;
  journal::Recorder::Options options;
  options.path = path;
  options.wall_clock = [&robot] { return kWall + robot.now.time_since_epoch().count(); };
  journal::Recorder recorder(value_of(journal::Writer::open(path, {})), options, session,
                             robot.manager().knowledge());
  robot.before_commands = [&](auto& observations, auto commands) {
    recorder.stepped(robot.now, observations, commands, robot.manager().events());
    return true;
  };
  robot.discover();
  play(robot);
}

void break_things(TestRobot& robot) {
  robot.run_for(7s);
  robot.fail("camera", "redeploy", 20s);
  robot.kill("fusion", 20s);
}

Repetition repeated(const std::filesystem::path& path) {
  const journal::Reader reader = value_of(journal::Reader::open(path));
  Recording recording = value_of(Recording::open(reader));
  return value_of(repeat(recording, reader, std::make_unique<BayesPlanner>(), {}));
}

TEST(Replay, DecidesTheSame) {
  const TestFolder folder;
  record(folder / "a.journal", break_things);
  const Repetition result = repeated(folder / "a.journal");
  EXPECT_FALSE(result.difference);
  EXPECT_GT(result.observations, 500u);
  EXPECT_GT(result.decisions, 5u);
  const journal::Reader reader = value_of(journal::Reader::open(folder / "a.journal"));
  EXPECT_TRUE(value_of(journal::verify(reader)).findings.empty());
}

TEST(Replay, SaysWhereItDecidesOtherwise) {
  const TestFolder folder;
  record(folder / "a.journal", break_things);
  const journal::Reader reader = value_of(journal::Reader::open(folder / "a.journal"));
  Recording recording = value_of(Recording::open(reader));
  struct Nothing : Planner {
    std::vector<Decision> plan(std::span<const RuleId>, const Knowledge&) const override {
      return {};
    }
  };
  const auto result = value_of(repeat(recording, reader, std::make_unique<Nothing>(), {}));
  ASSERT_TRUE(result.difference);
  EXPECT_THAT(result.difference->recorded,
              testing::Contains(HasSubstr("camera is held responsible")));
  EXPECT_THAT(result.difference->repeated,
              testing::Not(testing::Contains(HasSubstr("responsible"))));
}

// However the robot fares.
TEST(Replay, DecidesTheSameWhateverHappens) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    std::mt19937 random(seed);
    const TestFolder folder;
    record(folder / "a.journal", [&](TestRobot& robot) {
      for (int i = 0; i < 4; ++i) {
        robot.run_for(std::chrono::milliseconds(random() % 5000));
        const std::string name = random() % 2 == 0 ? "camera" : "fusion";
        switch (random() % 4) {
          case 0:
            robot[name].fault = random() % 2 == 0 ? "restart" : "redeploy";
            break;
          case 1:
            robot.kill(name);
            break;
          case 2:
            robot[name].loses_replies = !robot[name].loses_replies;
            break;
          default:
            robot[name].dies_at_start = !robot[name].dies_at_start;
        }
      }
      robot.run_for(5s);
    });
    EXPECT_FALSE(repeated(folder / "a.journal").difference) << "seed " << seed;
  }
}

TEST(Backtest, OtherRulesAdviseOnTheSameObservations) {
  const TestFolder folder;
  record(folder / "a.journal", break_things);
  const journal::Reader reader = value_of(journal::Reader::open(folder / "a.journal"));
  Recording recording = value_of(Recording::open(reader));
  // Other numbers for the same things, another strategy, and something that was never watched.
  const auto other = check(Source("other.rules", R"(
COMPONENT fusion NODE /fusion LAUNCH "fusion"
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Blind
  POLICIES ERROR
  TRIGGER age(/rgb) > 350ms || age(/lidar) > 1h
    STRATEGY swap 90 10
      ADAPTATION camera redeploy 10
)"));
  std::vector<std::string> chosen;
  const auto missing =
      value_of(advise(recording, *other.rules, std::make_unique<BayesPlanner>(),
                      [&](const Event& event, const RuleSet& rules) {
                        if (const auto* choice = std::get_if<StrategyChosen>(&event.what))
                          chosen.push_back(rules[choice->strategy].name);
                      }));
  EXPECT_THAT(chosen, testing::Contains("swap"));
  EXPECT_THAT(missing, testing::ElementsAre("topic /lidar"));
}

TEST(Recorder, LosesNothingWhileTheJournalCannotBeWritten) {
  const TestFolder folder;
  const auto path = folder / "later" / "a.journal";
  TestRobot robot(kReplayRules);
  robot.add("camera", {}, "/rgb");
  robot.add("fusion", {"camera"}, "/fused");
  std::ofstream(folder / "later") << "a file where a folder should be";
  std::vector<std::string> troubles;
  {
    journal::Session session;
    session.rules_text = kReplayRules;
    session.discovery = Manager::kDiscovery;
    journal::Recorder::Options options;
    options.path = path;
    options.wall_clock = [] { return kWall; };
    options.on_trouble = [&](const std::string& what) { troubles.push_back(what); };
    journal::Recorder recorder(std::nullopt, options, session, robot.manager().knowledge());
    robot.before_commands = [&](auto& observations, auto commands) {
      recorder.stepped(robot.now, observations, commands, robot.manager().events());
      return true;
    };
    robot.discover();
    break_things(robot);
    EXPECT_TRUE(robot.works("fusion")) << "the robot is managed all the same";
    std::filesystem::remove(folder / "later");
  }
  EXPECT_FALSE(repeated(path).difference);
  EXPECT_THAT(troubles, testing::Contains("the journal is written again"));
}

// ---- what rules would have seen in the last while

constexpr const char* kPatientRules = R"(
COMPONENT camera NODE /camera
COMPONENT lidar NODE /lidar
RULE CameraSilentForLong
  POLICIES ERROR
  TRIGGER age(/rgb) > 2s
    STRATEGY restart 50 10
      ADAPTATION camera restart 3
RULE LidarSilent
  POLICIES ERROR
  TRIGGER age(/scan) > 2s
    STRATEGY restart 50 10
      ADAPTATION lidar restart 3
)";

Hindsight in_hindsight(const std::filesystem::path& path, const RuleSet* rules, Duration since) {
  const journal::Reader reader = value_of(journal::Reader::open(path));
  const auto planner = [](const journal::Session&) -> Expected<std::unique_ptr<const Planner>> {
    return std::unique_ptr<const Planner>(std::make_unique<BayesPlanner>());
  };
  return value_of(hindsight(reader, rules, planner, kWall + since.count()));
}

std::vector<std::string> words(const std::vector<Said>& all) {
  constexpr const char* kWhat[] = {" detected", " gone", ": "};
  std::vector<std::string> words;
  for (const Said& each : all)
    words.push_back(each.rule + kWhat[static_cast<int>(each.what)] + each.strategy);
  return words;
}

// The camera is silent from 7 s to 12 s, fusion is killed at 30 s.
struct AnHour : testing::Test {
  AnHour() {
    record(folder / "a.journal", [](TestRobot& robot) {
      robot.run_for(7s - (robot.now - Time()));
      robot.fail("camera", "restart", 23s);
      robot.kill("fusion", 10s);
    });
  }
  const TestFolder folder;
};

TEST_F(AnHour, IsSeenByItsOwnRulesAsItWas) {
  const Hindsight whole = in_hindsight(folder / "a.journal", nullptr, 0s);
  EXPECT_THAT(words(whole.said),
              testing::IsSupersetOf({"CameraSilent detected", "CameraSilent: restart",
                                     "CameraSilent gone", "FusionSilent detected"}));
  EXPECT_THAT(whole.missing, testing::IsEmpty());
  EXPECT_NEAR(whole.until - whole.since, 40, 3);
  // From the middle on: the node of the camera appeared long before.
  const Hindsight end = in_hindsight(folder / "a.journal", nullptr, 20s);
  EXPECT_THAT(words(end.said), testing::Contains("FusionSilent detected"));
  EXPECT_THAT(words(end.said), testing::Not(testing::Contains(HasSubstr("CameraSilent"))));
  EXPECT_NEAR(end.since, 1'800'000'020.0, 0.5);
  for (const Said& each : end.said) EXPECT_GE(each.wall, end.since);
}

TEST_F(AnHour, IsSeenOtherwiseByOthers) {
  const RuleSet patient = *check(Source("patient", kPatientRules)).rules;
  const Hindsight whole = in_hindsight(folder / "a.journal", &patient, 0s);
  EXPECT_THAT(words(whole.said), testing::Each(testing::Not(HasSubstr("CameraSilent detected"))));
  EXPECT_THAT(whole.missing, testing::ElementsAre("topic /scan"));
}

TEST(Hindsight, SaysThatNothingIsRecorded) {
  const TestFolder folder;
  { const auto writer = value_of(journal::Writer::open(folder / "empty.journal", {})); }
  const journal::Reader reader = value_of(journal::Reader::open(folder / "empty.journal"));
  const auto found = hindsight(
      reader, nullptr,
      [](const journal::Session&) { return Expected<std::unique_ptr<const Planner>>(nullptr); }, 0);
  ASSERT_FALSE(found);
  EXPECT_THAT(found.error(), HasSubstr("nothing is recorded"));
}

}  // namespace
}  // namespace culprit::replay
