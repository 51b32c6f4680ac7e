// One fault, one alert: in virtual time, of a manager that heals a robot.
#include "live/alerting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "manager/test_robot.h"

namespace culprit::live {
namespace {

using namespace std::chrono_literals;
using alerts::Alert;
using test::TestRobot;
using testing::HasSubstr;

const std::string kAlertingRules = test::rules_of_camera_and_lamp("ROBOT rover\n", "REQUIRED");

struct Alerted {
  explicit Alerted(Approval approval = Approval::kNone, const std::string& rules = kAlertingRules) {
    Manager::Options options;
    options.governor.approval = approval;
    robot.emplace(rules, std::make_unique<BayesPlanner>(), options);
    test::add_camera_and_lamp(*robot);
    begin();
    robot->after_step = [this] {
      std::vector<Observation> none;
      alerting.stepped({robot->now, {}, none, {}, robot->manager().events()});
    };
    robot->discover();
    robot->signal("brightness", Value(1.0), 8s);
  }
  void begin() { alerting.begins(robot->manager(), {}, Time()); }
  // The manager is stepped when it wants to be, and when the alerting does.
  void run_for(Duration time) {
    for (const Time end = robot->now + time; robot->now < end;) {
      robot->run_for(std::min<Duration>(100ms, end - robot->now));
      std::vector<Observation> none;
      if (alerting.next_look() <= robot->now) alerting.stepped({robot->now, {}, none, {}, {}});
    }
  }
  std::vector<std::string> texts() const {
    std::vector<std::string> all;
    for (const Alert& each : posted) all.push_back(alerts::text_of(each));
    return all;
  }

  std::vector<Alert> posted;
  std::optional<TestRobot> robot;
  Alerting alerting{{.host = "pc", .link = [] { return std::string("http://page"); }},
                    [this](const Alert& alert) { posted.push_back(alert); },
                    [this] { return 1e9 + seconds(robot->now.time_since_epoch()); }};
};

TEST(Alerting, SaysNothingWhileAllIsWell) {
  Alerted alerted;
  alerted.run_for(10min);
  EXPECT_THAT(alerted.posted, testing::IsEmpty());
}

TEST(Alerting, TellsThatRulesAreBlindAndWhenTheyCanSeeAgain) {
  Alerted alerted;
  for (int i = 0; i < 10; ++i) {
    alerted.robot->signal("brightness", Value(1.0));
    alerted.run_for(1s);
  }
  alerted.run_for(5min);
  ASSERT_EQ(alerted.posted.size(), 1u) << testing::PrintToString(alerted.texts());
  EXPECT_EQ(alerted.posted[0].state, Alert::State::kFiring);
  EXPECT_EQ(alerted.posted[0].headline, "Dark is blind: no new value of brightness comes");
  EXPECT_EQ(alerted.posted[0].health, "NON_CRITICAL");
  EXPECT_TRUE(alerted.posted[0].needs_person);
  for (int i = 0; i < 120; ++i) {
    alerted.robot->signal("brightness", Value(1.0));
    alerted.run_for(1s);
  }
  ASSERT_EQ(alerted.posted.size(), 2u) << testing::PrintToString(alerted.texts());
  EXPECT_EQ(alerted.posted[1].state, Alert::State::kResolved);
}

TEST(Alerting, TellsOnceThatNoRuleCanSee) {
  std::vector<Alert> posted;
  TestRobot robot(kAlertingRules);
  Alerting alerting{{}, [&](const Alert& alert) { posted.push_back(alert); }, [] { return 1e9; }};
  alerting.begins(robot.manager(), {}, Time());
  for (int i = 0; i < 600; ++i) {
    robot.run_for(100ms);
    std::vector<Observation> none;
    alerting.stepped({robot.now, {}, none, {}, robot.manager().events()});
  }
  const auto of_sight = std::ranges::count_if(posted, [](const Alert& alert) {
    return alert.headline.starts_with("watching nothing, no rule can see: ");
  });
  EXPECT_EQ(of_sight, 1);
}

// No rule fires for it, and none is blind: the picture comes from the camera. The spare is one that a strategy starts.
TEST(Alerting, TellsOfAComponentThatWasNeverSeenAndThatAnErrorRuleNeeds) {
  std::vector<Alert> posted;
  TestRobot robot(R"(
COMPONENT camera NODE /camera
COMPONENT fusion NODE /fusion
COMPONENT spare  NODE /spare LAUNCH "spare"
COMPONENT lamp   NODE /lamp
RULE PictureSilent
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms
    STRATEGY restart_fusion 90 10
      ADAPTATION fusion restart 10
    STRATEGY start_spare 50 10
      ADAPTATION spare start 10
RULE PictureOld
  POLICIES WARNING
  TRIGGER age(/rgb) > 1s
    STRATEGY restart_lamp 90 10
      ADAPTATION lamp restart 2
)");
  robot.add("camera", {}, "/rgb");
  Alerting alerting{{}, [&](const Alert& alert) { posted.push_back(alert); }, [] { return 1e9; }};
  alerting.begins(robot.manager(), {}, Time());
  robot.discover();
  for (int i = 0; i < 600; ++i) {
    robot.run_for(100ms);
    std::vector<Observation> none;
    alerting.stepped({robot.now, {}, none, {}, robot.manager().events()});
  }
  ASSERT_EQ(posted.size(), 1u);
  EXPECT_EQ(posted[0].headline, "fusion was never seen");
  EXPECT_EQ(posted[0].health, "ERROR");
  EXPECT_EQ(posted[0].doing, "it is needed by PictureSilent");
  EXPECT_TRUE(posted[0].needs_person);
}

TEST(Alerting, TellsOfAFaultThatIsHealedAtOnceInOneMessage) {
  Alerted alerted;
  alerted.robot->kill("camera");
  alerted.run_for(5min);
  ASSERT_TRUE(alerted.robot->works("camera") && alerted.robot->works("fusion"));
  ASSERT_EQ(alerted.posted.size(), 1u) << testing::PrintToString(alerted.texts());
  const Alert& alert = alerted.posted[0];
  EXPECT_EQ(alert.state, Alert::State::kResolved);
  EXPECT_EQ(alert.headline, "camera is down");
  EXPECT_EQ(alert.robot, "rover");
  EXPECT_EQ(alert.link, "http://page");
  EXPECT_FALSE(alert.needs_person);
  EXPECT_THAT(alert.doing, HasSubstr("resolved by redeploy_camera"));
  EXPECT_LT(alert.ended - alert.began, 5);
}

TEST(Alerting, TellsOfAFaultThatLastsOnceAndWhenItIsOver) {
  Alerted alerted;
  alerted.robot->order({1, "Ann", "", Silence{ComponentId(0), {}}});
  alerted.robot->kill("camera");
  alerted.run_for(2min);
  ASSERT_EQ(alerted.posted.size(), 1u) << testing::PrintToString(alerted.texts());
  EXPECT_EQ(alerted.posted[0].state, Alert::State::kFiring);
  EXPECT_THAT(alerted.posted[0].doing, HasSubstr("not repaired: "));
  EXPECT_THAT(alerted.posted[0].consequences, testing::ElementsAre("FusionSilent"));
  alerted.robot->order({2, "Ann", "", LiftSilence{ComponentId(0)}});
  alerted.run_for(2min);
  ASSERT_EQ(alerted.posted.size(), 2u) << testing::PrintToString(alerted.texts());
  EXPECT_EQ(alerted.posted[1].state, Alert::State::kResolved);
  EXPECT_EQ(alerted.posted[1].id, alerted.posted[0].id);
}

TEST(Alerting, CallsAPersonAtOnceWhenNothingHelps) {
  Alerted alerted;
  (*alerted.robot)["camera"].fault = "nothing helps";
  alerted.run_for(5min);
  ASSERT_GE(alerted.posted.size(), 1u);
  EXPECT_LE(alerted.posted.size(), 2u) << testing::PrintToString(alerted.texts());
  const Alert& last = alerted.posted.back();
  EXPECT_TRUE(last.needs_person);
  EXPECT_EQ(last.health, "EXHAUSTED");
  EXPECT_THAT(alerts::text_of(last), HasSubstr("A PERSON IS NEEDED"));
  for (const Alert& each : alerted.posted) EXPECT_EQ(each.id, last.id) << "it is one fault";
}

TEST(Alerting, CallsAPersonIfNoRuleActsOnTheCause) {
  Alerted alerted(Approval::kNone, R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion LAUNCH "fusion"
COMPONENT lamp   NODE /lamp
RULE FusionSilent
  POLICIES ERROR
  TRIGGER age(/fused) > 300ms && brightness > 0.5
    STRATEGY restart_fusion 90 10
      ADAPTATION fusion restart 10
)");
  alerted.robot->kill("camera");
  alerted.run_for(5min);
  EXPECT_TRUE(alerted.robot->asked.empty()) << "fusion is well";
  ASSERT_GE(alerted.posted.size(), 1u);
  const Alert& last = alerted.posted.back();
  EXPECT_EQ(last.headline, "camera is down");
  EXPECT_TRUE(last.needs_person);
  EXPECT_EQ(last.next, "a person must look: no rule of these failures acts on camera")
      << testing::PrintToString(alerted.texts());
}

TEST(Alerting, AsksForApprovalAtOnce) {
  Alerted alerted(Approval::kEach);
  alerted.robot->kill("camera");
  alerted.run_for(2s);
  ASSERT_EQ(alerted.posted.size(), 1u) << testing::PrintToString(alerted.texts());
  EXPECT_TRUE(alerted.posted[0].needs_person);
  EXPECT_EQ(alerted.posted[0].doing, "waits for approval: redeploy camera");
}

TEST(Alerting, TellsTwoFaultsApart) {
  Alerted alerted;
  alerted.robot->order({1, "Ann", "", Pause{}});
  alerted.robot->kill("camera");
  alerted.robot->signal("brightness", Value(0.1));
  alerted.run_for(1min);
  ASSERT_EQ(alerted.posted.size(), 2u) << testing::PrintToString(alerted.texts());
  EXPECT_NE(alerted.posted[0].id, alerted.posted[1].id);
}

TEST(Alerting, GoesOnOverAReloadWithTheSameFault) {
  Alerted alerted;
  alerted.robot->order({1, "Ann", "", Pause{}});
  alerted.robot->kill("camera");
  alerted.run_for(10s);
  ASSERT_EQ(alerted.posted.size(), 1u) << testing::PrintToString(alerted.texts());
  alerted.begin();  // of a session: its manager says anew what is there
  alerted.run_for(2min);
  EXPECT_EQ(alerted.posted.size(), 1u) << testing::PrintToString(alerted.texts());
}

TEST(Alerting, TellsThatTheRobotCannotBeHeardAndThatItCanAgain) {
  Alerted alerted;
  alerted.robot->tell(HearingLost{"a test"});
  alerted.run_for(10s);
  ASSERT_EQ(alerted.posted.size(), 1u) << testing::PrintToString(alerted.texts());
  EXPECT_EQ(alerted.posted[0].headline, "culprit receives nothing from the robot");
  alerted.robot->tell(HearingRegained{});
  alerted.run_for(1min);
  EXPECT_EQ(alerted.posted.back().state, Alert::State::kResolved);
}

}  // namespace
}  // namespace culprit::live
