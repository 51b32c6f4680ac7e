// Before something is taken down, those upstream are asked whether they answer.
#include <gtest/gtest.h>

#include "manager/test_robot.h"
#include "plan/paper_planner.h"

namespace culprit::test {
namespace {

// The map serves navigation's requests; no topic shows that it works.
constexpr const char* kRulesOfNavigation = R"(
CYCLE 100ms
COMPONENT map NODE /map LAUNCH "map"
COMPONENT nav NODE /nav LAUNCH "nav"
RULE Nav
  POLICIES ERROR
  TRIGGER age(/cmd) > 300ms
    STRATEGY replace 90 10
      ADAPTATION nav redeploy 10
)";

struct Navigation {
  explicit Navigation(std::unique_ptr<const Planner> planner = std::make_unique<BayesPlanner>())
      : robot(kRulesOfNavigation, std::move(planner)) {
    robot.add("map").has_lifecycle = false;
    robot.add("nav", {"map"}, "/cmd").has_lifecycle = false;
    robot.discover();
    robot.tell(EndpointAppeared{"/nav", EndpointKind::kPublisher, "/cmd"});
  }
  void answers_at_first() { robot.tell(Probed{robot.id("map"), true}, 5s); }
  // It hangs, so that navigation does nothing either.
  void hang() {
    robot["map"].answers = false;
    robot["map"].fault = "redeploy";
  }
  void answer() {
    robot["map"].answers = true;
    robot["map"].fault.clear();
  }

  TestRobot robot;
};

// The questions of the last decision about the failure, with their answers.
std::vector<std::string> answers_in(const TestRobot& robot) {
  std::vector<std::string> answers;
  const auto read = [&](const auto& what) {
    if constexpr (requires { what.suspects; }) {
      if (what.suspects.empty()) return;
      answers.clear();
      for (const Suspect& suspect : what.suspects) {
        for (const Evidence& each : suspect.evidence) {
          if (each.source == EvidenceSource::kAnswer) answers.push_back(each.text);
        }
      }
    }
  };
  for (const Event& event : robot.events) std::visit(read, event.what);
  return answers;
}

TEST(Questions, ASupplierThatHangsIsFoundWithoutARuleAndItsConsumerIsLeftAlone) {
  Navigation navigation;
  navigation.answers_at_first();
  navigation.hang();
  TestRobot& robot = navigation.robot;
  robot.run_for(30s);
  EXPECT_TRUE(robot.was_asked("map: ask whether it answers"));
  EXPECT_FALSE(robot.was_asked("nav: stop process"));
  EXPECT_EQ(robot.count("Nav waits: it depends on map, which was asked whether it answers"), 1u);
  EXPECT_EQ(robot.count("Nav waits: it depends on map, which hangs"), 1u);
  EXPECT_LE(robot.count_asked("map: ask"), 16u) << "once per 2 s at most";
  EXPECT_EQ(answers_in(robot), std::vector<std::string>{"map did not answer"});
}

// It was busy for a while, and its consumer has a fault of its own.
TEST(Questions, AreAskedAgainUntilThereIsAnAnswer) {
  Navigation navigation;
  navigation.answers_at_first();
  TestRobot& robot = navigation.robot;
  robot["nav"].fault = "redeploy";
  robot["map"].answers = false;
  robot.run_for(10s);
  EXPECT_FALSE(robot.was_asked("nav: stop process"));
  robot["map"].answers = true;
  robot.run_for(4s);
  EXPECT_EQ(robot.count_asked("nav: stop process"), 1u);
  EXPECT_TRUE(robot.works("nav"));
}

TEST(Questions, ThatAreAnsweredDelayARepairByNoMoreThanTheAnswer) {
  Navigation navigation;
  navigation.answers_at_first();
  TestRobot& robot = navigation.robot;
  robot.fail("nav", "redeploy", 1s);
  EXPECT_EQ(robot.count_asked("map: ask"), 1u);
  std::optional<Time> detected;
  std::optional<Time> chosen;
  for (const Event& event : robot.events) {
    if (std::holds_alternative<FailureDetected>(event.what) && !detected) detected = event.at;
    if (std::holds_alternative<StrategyChosen>(event.what) && !chosen) chosen = event.at;
  }
  ASSERT_TRUE(detected && chosen);
  EXPECT_EQ(*chosen - *detected, 5ms);
  EXPECT_EQ(answers_in(robot), std::vector<std::string>{"map answered"})
      << "it is no suspect, since it answered";
  robot.run_for(5s);
  EXPECT_TRUE(robot.works("nav"));
}

TEST(Questions, AreAskedOnceOfWhatNeverAnswers) {
  Navigation navigation;
  TestRobot& robot = navigation.robot;
  robot["map"].answers = false;
  robot.run_for(5s);
  for (int i = 0; i < 2; ++i) {
    robot.fail("nav", "redeploy", 10s);
    EXPECT_EQ(robot.count_asked("map: ask"), 1u);
    EXPECT_EQ(robot.count_asked("nav: stop process"), static_cast<std::size_t>(i + 1));
    EXPECT_TRUE(robot.works("nav"));
  }
}

TEST(Questions, AreNotAwaitedForWhatIsKnownToBeDead) {
  Navigation navigation;
  navigation.answers_at_first();
  navigation.hang();
  TestRobot& robot = navigation.robot;
  robot.kill("nav", 600ms);
  EXPECT_TRUE(robot.was_asked("nav: start process"));
}

TEST(Questions, ALostAnswerIsNotAwaitedForLong) {
  Navigation navigation;
  navigation.answers_at_first();
  TestRobot& robot = navigation.robot;
  robot["nav"].fault = "redeploy";
  robot["map"].answers = false;
  robot["map"].lateness = 1h;
  robot.run_for(1200ms);
  EXPECT_EQ(robot.count_asked("map: ask"), 1u);
  EXPECT_TRUE(robot.was_asked("nav: stop process"));
}

// culprit could not receive an answer meanwhile.
TEST(Questions, ProveNothingWhileTheRobotCannotBeHeard) {
  Navigation navigation;
  navigation.answers_at_first();
  TestRobot& robot = navigation.robot;
  robot["nav"].fault = "redeploy";
  robot["map"].answers = false;
  while (!robot.was_asked("map: ask")) robot.run_for(10ms);
  robot.tell(HearingLost{"a test"}, 1s);
  robot["map"].answers = true;
  robot.tell(HearingRegained{}, 5s);
  EXPECT_TRUE(robot.was_asked("nav: stop process"));
  EXPECT_EQ(robot.count("which may be the cause"), 0u);
}

TEST(Questions, AreNotAskedByAPlannerThatDoesNotWeighCauses) {
  Navigation navigation(std::make_unique<PaperPlanner>());
  navigation.answers_at_first();
  navigation.hang();
  TestRobot& robot = navigation.robot;
  robot.run_for(3s);
  EXPECT_FALSE(robot.was_asked("map: ask"));
  EXPECT_TRUE(robot.was_asked("nav: stop process"));
}

// Many that serve nothing but one: those are asked that are nearest, and no more at once.
TEST(Questions, AreBoundedInNumber) {
  std::string rules = kRulesOfNavigation;
  std::vector<std::string> needs;
  for (int i = 0; i < 40; ++i) {
    needs.push_back("map" + std::to_string(i));
    rules.insert(rules.find("RULE"), "COMPONENT " + needs.back() + " NODE /" + needs.back() + "\n");
  }
  TestRobot robot(rules);
  for (int i = 0; i < 40; ++i) {
    // Ten are next to it; the others are behind the first of those, one behind the other.
    const bool is_far = i >= 10 && i < 39;
    robot
        .add(needs[static_cast<std::size_t>(i)],
             i == 0   ? std::vector<std::string>{needs[10]}
             : is_far ? std::vector<std::string>{needs[static_cast<std::size_t>(i) + 1]}
                      : std::vector<std::string>{})
        .has_lifecycle = false;
  }
  robot.add("nav", {needs.begin(), needs.begin() + 10}, "/cmd").has_lifecycle = false;
  robot.discover();
  robot.tell(EndpointAppeared{"/nav", EndpointKind::kPublisher, "/cmd"}, 5s);
  robot["nav"].fault = "redeploy";
  for (const std::string& each : needs) robot[each].answers = false;
  robot.run_for(700ms);
  EXPECT_EQ(robot.count_asked("ask whether"), 16u);
  for (int i = 0; i < 16; ++i) EXPECT_TRUE(robot.was_asked("map" + std::to_string(i) + ": ask"));
}

}  // namespace
}  // namespace culprit::test
