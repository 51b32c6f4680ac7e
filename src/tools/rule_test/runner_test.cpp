#include "rule_test/runner.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rule_test/restraint.h"
#include "rule_test/test_suite.h"

namespace culprit::rule_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// ---- each kind of expectation can be met, and can fail

constexpr const char* kCameraKilled = "AT 2s camera KILLED\nRUN 10s\n";
constexpr const char* kCameraHung = "AT 2s camera HUNG\nRUN 10s\n";
constexpr const char* kCameraSick =
    "TOPIC /rgb 2s: silent\nADAPTATION camera redeploy HEALS /rgb\nRUN 10s\n";
constexpr const char* kCameraLost = "TOPIC /rgb 2s: silent\nRUN 10min\n";

struct Case {
  const char* story;
  const char* met;
  const char* failing;
  const char* instead;
};

class EachExpectation : public testing::TestWithParam<Case> {};

TEST_P(EachExpectation, IsMetByWhatHappens) {
  const Played played = play(std::string(GetParam().story) + "EXPECT " + GetParam().met + "\n");
  EXPECT_TRUE(played.result.is_ok()) << played.text();
}

TEST_P(EachExpectation, FailsIfSomethingElseHappens) {
  const Played played = play(std::string(GetParam().story) + "EXPECT " + GetParam().failing + "\n");
  EXPECT_FALSE(played.result.is_ok());
  EXPECT_THAT(played.instead(), ElementsAre(HasSubstr(GetParam().instead))) << played.text();
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, EachExpectation,
    testing::Values(
        Case{kCameraKilled, "CameraDead DETECTED BY 2.5s", "Blurred DETECTED", "did not happen"},
        Case{kCameraKilled, "CameraDead DETECTED AFTER 2s", "CameraDead DETECTED BY 1s",
             "happened later, at 2.010 s"},
        Case{kCameraKilled, "NOT Blurred DETECTED", "NOT CameraDead DETECTED",
             "it happened at 2.010 s"},
        Case{kCameraKilled, "NOT CameraDead DETECTED BY 2s", "CameraDead DETECTED AFTER 5s",
             "too early, at 2.010 s"},
        Case{kCameraKilled, "CameraDead RESOLVED", "CameraDead RESOLVED BY 2.3s", "happened later"},
        Case{kCameraKilled, "CameraDead RESOLVED WITH camera_redeploy",
             "CameraDead RESOLVED WITH camera_restart", "did not happen"},
        Case{kCameraLost, "CameraDead EXHAUSTED", "NOT CameraDead EXHAUSTED", "happened at"},
        Case{"SIGNAL blur 1s: 0.9 2s: silent\nADAPTATION camera set_parameter UNANSWERED\nRUN "
             "1min\n",
             "Blurred LOST", "CameraDead LOST", "did not happen"},
        Case{"SIGNAL blur 1s: 0.1 2s: silent\nRUN 1min\n", "Blurred BLIND BY 15s",
             "CameraDead BLIND", "did not happen"},
        Case{kCameraKilled, "camera_redeploy CHOSEN BY 2.3s", "camera_restart CHOSEN",
             "did not happen"},
        Case{kCameraKilled, "camera_redeploy EXECUTED BY 3s", "camera_restart EXECUTED",
             "did not happen"},
        Case{kCameraSick, "camera_restart FAILED", "camera_redeploy FAILED", "did not happen"},
        Case{kCameraKilled, "camera BLAMED", "fusion BLAMED", "did not happen"},
        Case{kCameraHung, "camera BLAMED FOR FusionDead", "camera BLAMED FOR Blurred",
             "did not happen"},
        Case{kCameraKilled, "NO STRATEGY OF fusion", "NO STRATEGY OF camera", "happened at"},
        Case{kCameraKilled, "NO STRATEGY FOR FusionDead", "NO STRATEGY FOR CameraDead",
             "happened at"},
        Case{kCameraKilled, "NO STRATEGY BY 2s", "NO STRATEGY", "happened at 2.010 s"},
        Case{kCameraKilled, "camera_restart EXCLUDED BECAUSE invalid ON camera",
             "camera_restart EXCLUDED BECAUSE tried",
             "what was said of it: camera_restart is not possible now: camera is not alive"},
        Case{kCameraKilled, "fusion_redeploy EXCLUDED BECAUSE dependency ON camera",
             "fusion_redeploy EXCLUDED BECAUSE dependency ON fusion", "depends on camera"},
        Case{kCameraSick, "camera_redeploy EXCLUDED BECAUSE other_chosen", "focus EXCLUDED",
             "it was never weighed"},
        Case{kCameraSick, "camera_restart RANKED 1", "camera_redeploy RANKED 1",
             "its cost was number 2"}));

// ---- the robot

void expect_met(const std::string& test, const std::string& more_rules = "") {
  const Played played = play(test, more_rules);
  EXPECT_TRUE(played.result.is_ok()) << test << played.text();
}

TEST(ScriptedRobot, FallsSilentWithWhatItNeeds) {
  expect_met("AT 2s camera KILLED\nRUN 10s\nEXPECT FusionDead DETECTED\n");
}

TEST(ScriptedRobot, EndsOnlyTheStretchesThatHadBegunWhenItIsHealed) {
  expect_met(
      "SIGNAL blur 2s: 0.9 8s: 0.8\nSTRATEGY focus HEALS blur\nRUN 7s\n"
      "EXPECT Blurred RESOLVED BY 4s\n");
  expect_met(
      "SIGNAL blur 2s: 0.9 8s: 0.8\nSTRATEGY focus HEALS blur\nRUN 12s\n"
      "EXPECT Blurred DETECTED AFTER 8s\nEXPECT Blurred RESOLVED AFTER 8s\n");
}

TEST(ScriptedRobot, StaysSickIfNothingHealsIt) {
  expect_met("SIGNAL blur 2s: 0.9\nRUN 10s\nEXPECT NOT Blurred RESOLVED\n");
}

TEST(ScriptedRobot, RefusesWhatItIsToldToRefuse) {
  expect_met(
      "TOPIC /rgb 2s: silent\nADAPTATION camera restart REFUSED HEALS /rgb\n"
      "ADAPTATION camera redeploy HEALS /rgb AFTER 100ms\nRUN 10s\n"
      "EXPECT camera_restart FAILED BY 2.5s\nEXPECT NOT camera_restart EXECUTED\n"
      "EXPECT CameraDead RESOLVED WITH camera_redeploy\n");
}

TEST(ScriptedRobot, TakesItsTime) {
  expect_met(
      "AT 2s camera KILLED\nADAPTATION camera redeploy TAKES 4s\nRUN 10s\n"
      "EXPECT camera_redeploy EXECUTED AFTER 6s BY 6.3s\n");
}

TEST(ScriptedRobot, AnswersNothingWhileItHangs) {
  expect_met(
      "AT 2s camera HUNG\nRUN 20s\nEXPECT camera_restart FAILED\n"
      "EXPECT CameraDead RESOLVED WITH camera_redeploy\n");
}

constexpr const char* kFusionGone =
    "RULE FusionGone\n  POLICIES ERROR\n  TRIGGER !alive(fusion)\n"
    "    STRATEGY again 90 10\n      ADAPTATION fusion redeploy 5\n";

TEST(ScriptedRobot, IsNotAliveWhileItHangsThoughItPublishesNothing) {
  const char* idle = "TOPIC /fused 0s: silent\n";
  for (const char* story : {"COMPONENT fusion HUNG\n", "AT 2s fusion HUNG\n"}) {
    expect_met(idle + std::string(story) +
                   "RUN 10s\nEXPECT FusionGone RESOLVED WITH again BY 5s\nEXPECT fusion BLAMED\n",
               kFusionGone);
  }
}

TEST(ScriptedRobot, LeavesAComponentOutThatIsAbsentAndNobodyStartsIt) {
  expect_met(
      "COMPONENT camera STATE absent\nRUN 20s\nEXPECT NOT CameraDead DETECTED\n"
      "EXPECT NO STRATEGY OF camera\n");
}

TEST(ScriptedRobot, IsSilentWhileItIsInactive) {
  expect_met(
      "AT 2s camera STATE inactive\nRUN 10s\nEXPECT CameraDead RESOLVED WITH camera_restart\n");
}

TEST(ScriptedRobot, SurvivesComponentsThatNeedEachOther) {
  expect_met(
      "COMPONENT camera NEEDS fusion\nAT 2s camera KILLED\nRUN 10s\nEXPECT FusionDead DETECTED\n");
}

// ---- the governor, as culprit run has it

constexpr const char* kDocked = "SIGNAL docked DIAGNOSTIC base KEY docked\nINTERLOCK docked\n";

TEST(Runner, BeginsNothingWhileTheInterlockIsClosed) {
  for (const char* docked : {"SIGNAL docked 0s: false 5s: true\n", "SIGNAL docked 5s: true\n"}) {
    expect_met(std::string(docked) +
                   "AT 2s camera KILLED\nRUN 10s\nEXPECT NO STRATEGY BY 4.9s\n"
                   "EXPECT camera_redeploy EXCLUDED BECAUSE withheld ON camera BY 3s\n"
                   "EXPECT camera_redeploy EXCLUDED\n"
                   "EXPECT CameraDead RESOLVED WITH camera_redeploy AFTER 5s\n",
               kDocked);
  }
}

TEST(Runner, SaysThatTheInterlockWithheldAStrategy) {
  const Played played = play(
      "SIGNAL docked 0s: false\nAT 2s camera KILLED\nRUN 10s\n"
      "EXPECT camera_redeploy EXCLUDED BECAUSE tried\n",
      kDocked);
  EXPECT_THAT(played.instead(), ElementsAre(HasSubstr("INTERLOCK docked is false")));
  expect_met(
      "SIGNAL docked 0s: true\nAT 2s camera KILLED\nRUN 10s\n"
      "EXPECT NOT camera_redeploy EXCLUDED BECAUSE withheld\n",
      kDocked);
}

TEST(Runner, KeepsWithinTheBudgetOfAComponentWhateverFails) {
  const std::string rules =
      "COMPONENT lidar NODE /lidar LAUNCH \"lidar\"\n"
      "RULE Stuck\n  POLICIES ERROR ATTEMPTS 1000\n  TRIGGER stuck > 0.5\n"
      "    STRATEGY again 50 10\n      ADAPTATION lidar restart 1\n"
      "    STRATEGY anew 50 10\n      ADAPTATION lidar redeploy 2\n"
      "RULE Rough\n  POLICIES WARNING ATTEMPTS 1000\n  TRIGGER rough > 0.5\n"
      "    STRATEGY smooth 50 10\n      ADAPTATION lidar set_parameter smooth true 1\n";
  const Played played =
      play("SIGNAL stuck 1s: 1\nSIGNAL rough 1s: 1\nRUN 10min\nEXPECT Stuck DETECTED\n", rules);
  const Intensity bound = restraint().limits.per_component;
  std::vector<Time> begun;
  std::ptrdiff_t most = 0;
  for (const Event& event : played.result.events) {
    if (!std::holds_alternative<StrategyChosen>(event.what)) continue;
    begun.push_back(event.at);
    most = std::max(most, std::count_if(begun.begin(), begun.end(),
                                        [&](Time at) { return event.at - at < bound.period; }));
  }
  EXPECT_EQ(most, bound.most) << played.text();
}

constexpr const char* kMapper =
    "COMPONENT mapper NODE /mapper LAUNCH \"mapper\"\n"
    "RULE MapDead\n  POLICIES ERROR\n  TRIGGER age(/map) > 350ms\n"
    "    STRATEGY mapper_redeploy 90 10\n      ADAPTATION mapper redeploy 5\n"
    "RULE MapSilentOrBlind\n  POLICIES ERROR\n  TRIGGER age(/rgb) > 350ms\n"
    "    STRATEGY guess 90 10\n      ADAPTATION mapper redeploy 5\n";

TEST(Runner, DoesNotReplaceAComponentThatIsHeardWhenAnotherIsSilent) {
  expect_met(
      "COMPONENT mapper PUBLISHES /map\nTOPIC /map 0s: 10Hz\nTOPIC /rgb 2s: silent\nRUN 30s\n"
      "EXPECT guess EXCLUDED BECAUSE withheld ON mapper\nEXPECT NO STRATEGY OF mapper\n",
      kMapper);
}

// ---- values over a time

constexpr const char* kArm =
    "COMPONENT arm NODE /arm LAUNCH \"arm\"\nSIGNAL joint TOPIC /joints FIELD data STALE 500ms\n"
    "RULE Frozen\n  POLICIES ERROR\n  TRIGGER stddev(joint, 2s) == 0\n"
    "    STRATEGY arm_redeploy 90 10\n      ADAPTATION arm redeploy 25\n"
    "RULE NoNumber\n  POLICIES WARNING REPORT\n  TRIGGER isnan(joint)\n";

TEST(Runner, AWindowActsOnNothingUntilItIsCovered) {
  for (const char* course : {
           "SIGNAL joint EVERY 20ms 0s: 0.3\nRUN 1900ms\n",
           "SIGNAL joint EVERY 20ms 20s: 0.3\nRUN 21900ms\n",
           "SIGNAL joint EVERY 20ms 0s: 0.3 1s: silent 3s: 0.3\nRUN 4900ms\n",
           "SIGNAL joint EVERY 20ms 0s: 0.3 1900ms: nan 2s: 0.3\nRUN 3900ms\n",
       }) {
    expect_met(std::string(course) + "EXPECT NOT Frozen DETECTED\n", kArm);
  }
  for (const char* course : {
           "SIGNAL joint EVERY 20ms 0s: 0.3\nRUN 3s\nEXPECT Frozen DETECTED BY 2.1s\n",
           "SIGNAL joint EVERY 20ms 0s: 0.3 1s: silent 3s: 0.3\nRUN 6s\n"
           "EXPECT Frozen DETECTED AFTER 5s\n",
       }) {
    expect_met(course, kArm);
  }
}

TEST(Runner, AValueThatIsNotANumberIsSeenByARuleForIt) {
  const Played played = play(
      "SIGNAL joint EVERY 20ms 0s: 0.3 1s: nan\nRUN 3s\nEXPECT NoNumber DETECTED AFTER 1s\n"
      "EXPECT NOT Frozen DETECTED\n",
      kArm);
  EXPECT_TRUE(played.result.is_ok()) << played.text();
  EXPECT_EQ(std::ranges::count_if(
                played.result.events,
                [](const Event& e) { return std::holds_alternative<ValueUnknown>(e.what); }),
            1);
}

// ---- one publisher of several

TEST(Runner, OneOfTwoPublishersIsSilent) {
  expect_met(
      "COMPONENT front PUBLISHES /scan\nCOMPONENT rear PUBLISHES /scan\n"
      "TOPIC /scan FROM front 0s: 10Hz 7s: silent\nTOPIC /scan FROM rear 0s: 10Hz\n"
      "ADAPTATION front redeploy HEALS /scan\nRUN 20s\n"
      "EXPECT FrontSilent DETECTED AFTER 7s\nEXPECT NOT AllSilent DETECTED\n"
      "EXPECT front BLAMED FOR FrontSilent\nEXPECT NO STRATEGY OF rear\n",
      "COMPONENT front NODE /front /front/filter LAUNCH \"front\"\n"
      "COMPONENT rear NODE /rear LAUNCH \"rear\"\n"
      "RULE FrontSilent\n  POLICIES ERROR\n  TRIGGER age(/scan FROM front) > 1s || !alive(front)\n"
      "    STRATEGY front_redeploy 90 10\n      ADAPTATION front redeploy 25\n"
      "RULE RearSilent\n  POLICIES ERROR\n  TRIGGER age(/scan FROM rear) > 1s\n"
      "    STRATEGY rear_redeploy 90 10\n      ADAPTATION rear redeploy 25\n"
      "RULE AllSilent\n  POLICIES WARNING REPORT\n  TRIGGER age(/scan) > 1s\n");
}

TEST(Runner, GoalsThatAreAborted) {
  expect_met(
      "GOAL /go 20s..22s aborted\nGOAL /go 25s..30s aborted\nGOAL /go 31s\nRUN 1min\n"
      "EXPECT Aborted DETECTED AFTER 30s\nEXPECT Slow DETECTED AFTER 41s\n",
      "RULE Aborted\n  POLICIES WARNING REPORT\n  TRIGGER goals(/go, aborted, 15s) >= 2\n"
      "RULE Slow\n  POLICIES WARNING REPORT\n  TRIGGER goal_age(/go) > 10s\n");
}

TEST(Runner, LinesOfALogAreCountedByTheirLevel) {
  expect_met(
      "COMPONENT camera\nLOG camera WARN 1s..9s\nLOG camera ERROR 20s\nLOG camera FATAL 25s\nLOG "
      "camera ERROR "
      "40s..42s\nRUN 1min\nEXPECT Two DETECTED AFTER 25s\nEXPECT Many DETECTED AFTER 41s\n",
      "RULE Two\n  POLICIES WARNING REPORT\n  TRIGGER logs(camera, ERROR, 10s) >= 2\n"
      "RULE Many\n  POLICIES WARNING REPORT\n  TRIGGER logs(camera, ERROR, 10s) > 10\n");
}

// ---- the same again

TEST(Runner, PlaysTheSameTestTheSameWay) {
  const std::string story =
      "AT 2s camera KILLED\nAT 2s fusion HUNG\nSIGNAL blur 1.5s: 0.9 4s..6s: silent\n"
      "STRATEGY focus HEALS blur AFTER 70ms\nRUN 1min\nEXPECT NO STRATEGY\n";
  const std::string first = play(story).text();
  EXPECT_EQ(first, play(story).text());
  EXPECT_THAT(first, HasSubstr("camera is held responsible"));
}

TEST(Runner, LeavesAHealthyRobotAlone) {
  const Played played = play("RUN 1min\nEXPECT NO STRATEGY\n");
  EXPECT_TRUE(played.result.is_ok()) << played.text();
  EXPECT_THAT(played.instead(), IsEmpty());
}

}  // namespace
}  // namespace culprit::rule_test
