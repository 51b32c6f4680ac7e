// Last resorts never wait (docs/governor.md): whatever holds the other strategies of their rule, they
// are begun within their time. Only a person's pause holds them, and it says so.
#include <gtest/gtest.h>

#include "manager/test_robot.h"
#include "plan/paper_planner.h"

namespace culprit::test {
namespace {

std::unique_ptr<const Planner> resort_paper() { return std::make_unique<PaperPlanner>(); }
std::unique_ptr<const Planner> resort_bayes() { return std::make_unique<BayesPlanner>(); }

class LastResort : public testing::TestWithParam<PlannerFactory> {
 protected:
  // A localization that can be restarted, and a base that drives.
  TestRobot driving(const std::string& rules, Manager::Options options = {}) const {
    TestRobot robot(
        "COMPONENT loc NODE /loc LAUNCH \"loc\"\nCOMPONENT base NODE /base LAUNCH \"base\"\n" +
            rules,
        GetParam()(), options);
    robot.add("loc", {}, "/pose");
    robot.add("base").parameters["max_speed"] = Value(1.0);
    robot.discover(4s);
    return robot;
  }
};
INSTANTIATE_TEST_SUITE_P(EachPlanner, LastResort, testing::Values(resort_paper, resort_bayes),
                         [](const auto& test) { return test.index == 0 ? "paper" : "bayes"; });

std::string loc_lost(const std::string& within = "", const std::string& other = "restart 5") {
  return "RULE LocLost\nPOLICIES ERROR ATTEMPTS 4\nTRIGGER age(/pose) > 500ms\n"
         "STRATEGY help 60 10\nADAPTATION loc " +
         other + "\nSTRATEGY stand_still 100 10 LASTRESORT" + within +
         "\nADAPTATION base set_parameter max_speed 0.0 1\n";
}

bool stands_still(TestRobot& robot) { return robot["base"].parameters["max_speed"] == Value(0.0); }

std::optional<Time> first_detection(const TestRobot& robot) {
  for (const Event& event : robot.events) {
    if (std::holds_alternative<FailureDetected>(event.what)) return event.at;
  }
  return std::nullopt;
}

// When the first last resort was begun after the first detection.
std::optional<Duration> last_resort_waited(const TestRobot& robot) {
  for (const Event& event : robot.events) {
    const auto* chosen = std::get_if<StrategyChosen>(&event.what);
    if (chosen != nullptr && robot.rules()[chosen->strategy].is_last_resort)
      return event.at - *first_detection(robot);
  }
  return std::nullopt;
}

void expect_last_resort_within(const TestRobot& robot, Duration time) {
  const auto begun = last_resort_waited(robot);
  ASSERT_TRUE(begun);
  EXPECT_LE(*begun, time);
}

TEST_P(LastResort, OpensTheInterlockBehindWhichTheRepairWaits) {
  TestRobot robot = driving("INTERLOCK speed < 0.1\n" + loc_lost());
  robot.signal("speed", Value(1.0));
  robot.fail("loc", "restart", 3s);
  EXPECT_TRUE(stands_still(robot));
  expect_last_resort_within(robot, 0s);  // an interlock opens at no known time
  EXPECT_FALSE(robot.works("loc"));
  robot.signal("speed", Value(0.0), 5s);
  EXPECT_TRUE(robot.works("loc")) << "the repair goes on";
  EXPECT_EQ(robot.count("LocLost resolved by help"), 1u);
  EXPECT_EQ(robot.count("exhausted"), 0u);
  EXPECT_TRUE(stands_still(robot)) << "it is not undone";
}

TEST_P(LastResort, GoesBesideAStrategyThatCannotHelpInTime) {
  TestRobot robot = driving(loc_lost(" WITHIN 1s", "redeploy 60"));
  robot.fail("loc", "redeploy", 1200ms);
  EXPECT_TRUE(stands_still(robot));
  expect_last_resort_within(robot, 0s);
  robot.run_for(10s);
  EXPECT_TRUE(robot.works("loc")) << "the redeploy went on";
  EXPECT_EQ(robot.count_asked("loc: start process"), 1u);
}

TEST_P(LastResort, ComesInItsTimeIfTheOthersDoNotHelp) {
  TestRobot robot = driving(loc_lost(" WITHIN 3s"));
  robot.fail("loc", "a person", 1500ms);
  EXPECT_FALSE(stands_still(robot)) << "the others have their time";
  robot.run_for(2500ms);
  EXPECT_TRUE(stands_still(robot));
  expect_last_resort_within(robot, 3s);
  EXPECT_EQ(robot.count("exhausted"), 0u);
  robot.run_for(60s);
  EXPECT_EQ(robot.count("(help, "), 4u) << "ATTEMPTS are the others'";
  EXPECT_EQ(robot.count("(stand_still, "), 1u);
  EXPECT_EQ(robot.count("LocLost is exhausted"), 1u);
}

TEST_P(LastResort, DoesNotComeIfTheOthersHelpInTime) {
  TestRobot robot = driving(loc_lost(" WITHIN 3s"));
  robot.fail("loc", "restart", 10s);
  EXPECT_TRUE(robot.works("loc"));
  EXPECT_FALSE(stands_still(robot));
}

TEST_P(LastResort, DoesNotWaitForAStorm) {
  Manager::Options options;
  options.governor.storm.share = 0.1;
  std::string rules = loc_lost();
  for (int i = 0; i < 4; ++i) {
    const std::string n = std::to_string(i);
    rules += "COMPONENT x" + n + " NODE /x" + n + " LAUNCH \"x\"\nRULE X" + n +
             "\nPOLICIES ERROR\nTRIGGER age(/x" + n +
             ") > 300ms\nSTRATEGY redeploy 90 10\nADAPTATION x" + n + " redeploy 2\n";
  }
  TestRobot robot("COMPONENT loc NODE /loc LAUNCH \"loc\"\nCOMPONENT base NODE /base\n" + rules,
                  GetParam()(), options);
  robot.add("loc", {}, "/pose");
  robot.add("base").parameters["max_speed"] = Value(1.0);
  for (int i = 0; i < 4; ++i) robot.add("x" + std::to_string(i), {}, "/x" + std::to_string(i));
  robot.discover(4s);
  for (int i = 0; i < 4; ++i) robot["x" + std::to_string(i)].fault = "redeploy";
  robot.fail("loc", "restart", 4s);
  EXPECT_GE(robot.count("a person must look: "), 1u);
  EXPECT_TRUE(stands_still(robot));
}

TEST_P(LastResort, DoesNotWaitForABudgetAndSpendsNone) {
  Manager::Options options;
  options.governor.limits.overall = {1, 1h};
  TestRobot robot = driving(loc_lost(), options);
  robot.fail("loc", "a person", 30s);
  EXPECT_TRUE(stands_still(robot));
  expect_last_resort_within(robot, 2s);
  EXPECT_EQ(robot.count("(help, "), 1u);
}

TEST_P(LastResort, DoesNotWaitForABackoff) {
  Manager::Options options;
  options.governor.limits.backoff = {30s, 60s, 60s};
  TestRobot robot = driving(loc_lost(), options);
  robot.fail("loc", "a person", 4s);
  EXPECT_TRUE(stands_still(robot));
  expect_last_resort_within(robot, 2s);
}

TEST_P(LastResort, NeedsNoApproval) {
  Manager::Options options;
  options.governor.approval = Approval::kEach;
  TestRobot robot = driving(loc_lost(), options);
  robot.fail("loc", "restart", 4s);
  EXPECT_TRUE(stands_still(robot));
  expect_last_resort_within(robot, 2s);
  EXPECT_EQ(robot.manager().governor().asked(), std::vector{StrategyId(0)})
      << "the person is still asked about the repair";
}

TEST_P(LastResort, IsNotHeldByTheQuietPeriodAtTheStart) {
  Manager::Options options;
  options.governor.quiet_at_start = 60s;
  TestRobot robot = driving(loc_lost(), options);
  robot.fail("loc", "restart", 2s);
  EXPECT_TRUE(stands_still(robot));
}

std::string lidar_rule() {
  return "COMPONENT lid NODE /lid LAUNCH \"lid\"\nRULE Lid\nPOLICIES ERROR ATTEMPTS 2\n"
         "TRIGGER age(/scan) > 350ms\nSTRATEGY redeploy 90 10\nADAPTATION lid redeploy 5\n";
}

// Its cause waits for a person, or is being repaired: that is no reason either.
TEST_P(LastResort, DoesNotWaitForTheCauseOfItsFailure) {
  for (const std::string fault : {"a person", "redeploy"}) {
    TestRobot robot("COMPONENT loc NODE /loc LAUNCH \"loc\"\nCOMPONENT base NODE /base\n" +
                        lidar_rule() + loc_lost(),
                    GetParam()());
    robot.add("lid", {}, "/scan");
    robot.add("loc", {"lid"}, "/pose");
    robot.add("base").parameters["max_speed"] = Value(1.0);
    robot.discover(4s);
    robot["lid"].start_time = 10s;
    robot.fail("lid", fault, 5s);
    EXPECT_TRUE(stands_still(robot)) << fault;
    expect_last_resort_within(robot, 3s);
    robot.run_for(60s);
    EXPECT_FALSE(robot.was_asked("loc:")) << fault;
    EXPECT_EQ(robot.count("(stand_still, "), 1u) << fault;
  }
}

// On an unreachable computer.
TEST_P(LastResort, DoesNotWaitForAHost) {
  TestRobot robot(
      "COMPONENT loc NODE /loc LAUNCH \"loc\"\nCOMPONENT base NODE /base\n" + loc_lost(),
      GetParam()());
  robot.add("loc", {}, "/pose").host = "rover2";
  robot.add("base").parameters["max_speed"] = Value(1.0);
  robot.discover(4s);
  robot.cut("rover2", 8s);
  EXPECT_TRUE(stands_still(robot));
  expect_last_resort_within(robot, 2s);
}

// Each of two rules has its own; both stop the same base.
TEST_P(LastResort, OfTwoRulesDoNotWaitForEachOther) {
  TestRobot robot = driving(loc_lost() +
                            "RULE Blind\nPOLICIES WARNING\nTRIGGER sight < 0.5\n"
                            "STRATEGY look 60 10\nADAPTATION loc set_parameter light 1 50\n"
                            "STRATEGY slow 100 10 LASTRESORT\n"
                            "ADAPTATION base set_parameter max_turn 0.0 1\n");
  robot["base"].parameters["max_turn"] = Value(1.0);
  robot["loc"].parameters["light"] = Value(std::int64_t{0});
  robot.signal("sight", Value(0.1));
  robot.fail("loc", "a person", 4s);
  EXPECT_TRUE(stands_still(robot));
  EXPECT_EQ(robot["base"].parameters["max_turn"], Value(0.0));
}

// Another rule's strategy has the base.
TEST_P(LastResort, GoesToAComponentThatIsBeingAdapted) {
  TestRobot robot = driving(loc_lost() +
                            "RULE Hot\nPOLICIES ERROR\nTRIGGER heat > 80\n"
                            "STRATEGY fan 60 10\nADAPTATION base set_parameter fan 1 100\n");
  robot["base"].parameters["fan"] = Value(std::int64_t{0});
  robot.signal("heat", Value(90.0), 500ms);
  ASSERT_TRUE(robot.was_asked("base: set fan"));
  robot.fail("loc", "a person", 4s);
  EXPECT_TRUE(stands_still(robot));
  EXPECT_EQ(robot["base"].parameters["fan"], Value(std::int64_t{1}));
}

// A strategy that would set the same thing yields; it is not undone afterwards, and does not come back
// while the last resort stands.
TEST_P(LastResort, StaysAgainstOtherStrategies) {
  TestRobot robot = driving(loc_lost() +
                            "RULE Late\nPOLICIES ERROR\nTRIGGER delay > 5\nSTRATEGY faster 60 10\n"
                            "ADAPTATION base set_parameter max_speed 2.0 10\n");
  robot.signal("delay", Value(10.0), 500ms);
  ASSERT_EQ(robot["base"].parameters["max_speed"], Value(2.0));
  robot.fail("loc", "a person", 4s);
  EXPECT_TRUE(stands_still(robot));
  robot.run_for(60s);
  EXPECT_TRUE(stands_still(robot));
  robot["loc"].fault.clear();
  robot.run_for(100ms);
  EXPECT_TRUE(stands_still(robot)) << "it is not undone";
}

TEST_P(LastResort, YieldsToAPersonsOrder) {
  TestRobot robot = driving(loc_lost() +
                            "RULE Late\nPOLICIES ERROR\nTRIGGER delay > 5\nSTRATEGY faster 60 10\n"
                            "ADAPTATION base set_parameter max_speed 2.0 10\n");
  robot.fail("loc", "a person", 4s);
  ASSERT_TRUE(stands_still(robot));
  robot.order({1, "Ann", "", RunStrategy{StrategyId(2)}}, 10s);
  EXPECT_EQ(robot["base"].parameters["max_speed"], Value(2.0));
}

// A strategy of its own rule fails after it: what that had set before is not set again.
TEST_P(LastResort, IsNotUndoneByTheUndoingOfAnother) {
  TestRobot robot = driving(
      "RULE LocLost\nPOLICIES ERROR ATTEMPTS 1\nTRIGGER age(/pose) > 500ms\n"
      "STRATEGY slower 60 10\nADAPTATION base set_parameter max_speed 0.5 20\n"
      "STRATEGY stand_still 100 10 LASTRESORT WITHIN 5s\n"
      "ADAPTATION base set_parameter max_speed 0.0 1\n");
  robot.fail("loc", "a person", 60s);
  EXPECT_TRUE(stands_still(robot));
}

TEST_P(LastResort, IsDoneAnewInAProcessThatBeganAnew) {
  TestRobot robot = driving(loc_lost() +
                            "RULE Base\nPOLICIES ERROR\nTRIGGER !alive(base)\n"
                            "STRATEGY again 90 10\nADAPTATION base redeploy 5\n");
  robot.fail("loc", "a person", 4s);
  ASSERT_TRUE(stands_still(robot));
  robot.kill("base");
  robot["base"].parameters["max_speed"] = Value(1.0);
  robot.run_for(10s);
  EXPECT_TRUE(robot.works("base"));
  EXPECT_TRUE(stands_still(robot));
}

TEST_P(LastResort, IsTriedAgainIfItCouldNotBeCarriedOut) {
  TestRobot robot = driving(loc_lost());
  robot["base"].refuses = true;
  robot.fail("loc", "a person", 8s);
  ASSERT_GE(robot.count("stand_still did not resolve"), 1u);
  robot["base"].refuses = false;
  robot.run_for(10s);
  EXPECT_TRUE(stands_still(robot));
}

// The process may have been about to end when it refused.
TEST_P(LastResort, IsTriedAgainInANewProcessAfterAllAttempts) {
  std::string once = loc_lost();
  once.replace(once.find("ATTEMPTS 4"), 10, "ATTEMPTS 1");
  TestRobot robot = driving(once);
  robot["base"].refuses = true;
  robot.fail("loc", "a person", 8s);
  robot["base"].refuses = false;
  robot.run_for(8s);
  ASSERT_EQ(robot.count("stand_still did not resolve"), 1u);
  ASSERT_FALSE(stands_still(robot));
  robot.kill("base", 3s);
  robot.start_by_hand("base", 3s);
  EXPECT_TRUE(stands_still(robot));
}

// It may go on at any moment, and obeys then.
TEST_P(LastResort, IsAskedOfAComponentThatHangs) {
  TestRobot robot = driving(loc_lost());
  robot.stop("base", 3s);
  robot.fail("loc", "a person", 5s);
  EXPECT_TRUE(robot.was_asked("base: set max_speed"));
  EXPECT_EQ(robot.count("held back"), 0u);
}

// It is said that the safe stop cannot be done, and it is done as soon as it can be.
TEST_P(LastResort, WaitsForItsComponentAndSaysSo) {
  TestRobot robot = driving(loc_lost());
  robot.kill("base", 3s);
  robot.fail("loc", "a person", 5s);
  EXPECT_EQ(robot.count("LocLost.stand_still is held back: base is not alive"), 1u);
  robot.start_by_hand("base", 3s);
  EXPECT_TRUE(stands_still(robot));
}

TEST_P(LastResort, SeveralFollowEachOther) {
  TestRobot robot = driving(loc_lost() +
                            "STRATEGY brake 100 10 LASTRESORT WITHIN 4s\n"
                            "ADAPTATION base set_parameter brake true 1\n");
  robot["base"].parameters["brake"] = Value(false);
  robot.fail("loc", "a person", 3500ms);
  EXPECT_TRUE(stands_still(robot));
  EXPECT_EQ(robot["base"].parameters["brake"], Value(false));
  robot.run_for(2s);
  EXPECT_EQ(robot["base"].parameters["brake"], Value(true));
}

// The base cannot slow down: power is cut in the time of that one.
class LastResortsOfTwo : public LastResort {
 protected:
  TestRobot driving() const {
    TestRobot robot = LastResort::driving(
        "COMPONENT motor NODE /motor LAUNCH \"motor\"\n" + loc_lost() +
        "STRATEGY cut 100 10 LASTRESORT WITHIN 3s\nADAPTATION motor set_parameter cut true 1\n");
    robot.add("motor").parameters["cut"] = Value(false);
    robot.discover(4s);
    return robot;
  }
  static void expect_cut_in_time(TestRobot& robot) {
    robot.fail("loc", "a person", 4s);
    EXPECT_EQ(robot["motor"].parameters["cut"], Value(true));
  }
};
INSTANTIATE_TEST_SUITE_P(EachPlanner, LastResortsOfTwo, testing::Values(resort_paper, resort_bayes),
                         [](const auto& test) { return test.index == 0 ? "paper" : "bayes"; });

TEST_P(LastResortsOfTwo, TheSecondDoesNotWaitForOneThatIsRefused) {
  TestRobot robot = driving();
  robot["base"].refuses = true;
  expect_cut_in_time(robot);
  robot["base"].refuses = false;
  robot.run_for(10s);
  EXPECT_TRUE(stands_still(robot)) << "it is tried again";
}

TEST_P(LastResortsOfTwo, TheSecondDoesNotWaitForOneWhoseComponentIsDown) {
  TestRobot robot = driving();
  robot.kill("base", 3s);
  expect_cut_in_time(robot);
  robot.start_by_hand("base", 3s);
  EXPECT_TRUE(stands_still(robot));
}

TEST_P(LastResort, ComesAgainWithTheFailure) {
  TestRobot robot = driving(loc_lost());
  for (int time = 0; time < 2; ++time) {
    robot.fail("loc", "a person", 4s);
    EXPECT_TRUE(stands_still(robot)) << time;
    robot["loc"].fault.clear();
    robot.run_for(4s);
    robot["base"].parameters["max_speed"] = Value(1.0);
  }
}

std::string goes_on(const std::string& is_safe) {
  return "RULE StopIsOver\nPOLICIES NON_CRITICAL FOR 1s\nTRIGGER speed < 0.1 && " + is_safe +
         "\nSTRATEGY go_on 95 10\nADAPTATION base set_parameter max_speed 1.0 2\n";
}

// The base reports its speed.
void drive_for(TestRobot& robot, Duration time) {
  for (const Time end = robot.now + time; robot.now < end; robot.run_for(100ms)) {
    robot.signal("speed", robot["base"].parameters["max_speed"]);
    robot.signal("heat", Value(stands_still(robot) ? 1.0 : 3.0));
  }
}

// The rule that ends the safe stop is not why the failure comes again.
TEST_P(LastResort, IsTakenBackAfterEachFailure) {
  TestRobot robot = driving(goes_on("age(/pose) < 300ms") + loc_lost(" WITHIN 1s", "redeploy 60"));
  for (std::size_t time = 1; time <= 4; ++time) {
    robot["loc"].fault = "redeploy";
    drive_for(robot, 1s);
    EXPECT_TRUE(stands_still(robot));
    drive_for(robot, 9s);
    EXPECT_FALSE(stands_still(robot));
    EXPECT_EQ(robot.count("StopIsOver resolved by go_on"), time);
  }
}

// Here it is: driving on brings the failure back.
TEST_P(LastResort, IsNotTakenBackForEver) {
  TestRobot robot = driving(goes_on("heat < 2") +
                            "RULE Hot\nPOLICIES ERROR\nTRIGGER heat > 2\n"
                            "STRATEGY begin_anew 50 10\nADAPTATION loc restart 40\n"
                            "STRATEGY cool 100 10 LASTRESORT WITHIN 1s\n"
                            "ADAPTATION base set_parameter max_speed 0.0 1\n");
  drive_for(robot, 10min);
  EXPECT_TRUE(stands_still(robot));
  EXPECT_LE(robot.count_asked("base: set max_speed"), 20u);
}

TEST_P(LastResort, ThatHelpedIsNamed) {
  TestRobot robot = driving(
      "RULE TooFast\nPOLICIES ERROR\nTRIGGER speed > 3\nSTRATEGY gear 60 10\n"
      "ADAPTATION loc set_parameter gear 1 50\nSTRATEGY stand_still 100 10 LASTRESORT\n"
      "ADAPTATION base set_parameter max_speed 0.0 5\n");
  robot["loc"].parameters["gear"] = Value(std::int64_t{0});
  robot.signal("speed", Value(4.0), 200ms);
  ASSERT_TRUE(stands_still(robot));
  robot.signal("speed", Value(0.0), 3s);
  EXPECT_EQ(robot.count("TooFast resolved by"), 1u);
}

TEST_P(LastResort, NothingIsLearnedOfIt) {
  TestRobot robot = driving(loc_lost());
  robot.fail("loc", "a person", 120s);
  const Belief belief = robot.manager().knowledge().beliefs[StrategyId(1)];
  EXPECT_DOUBLE_EQ(belief.alpha, 10);
}

TEST_P(LastResort, IsHeldByAPauseThatSaysSo) {
  TestRobot robot = driving(loc_lost());
  robot.order({1, "Ann", "", Pause{}});
  EXPECT_EQ(robot.count("this holds back the last resort LocLost.stand_still"), 1u);
  robot.fail("loc", "a person", 10s);
  EXPECT_FALSE(stands_still(robot));
  EXPECT_EQ(robot.count("LocLost.stand_still is held back: paused by a person"), 1u);
  robot.order({1, "Ann", "", Resume{}}, 1s);
  EXPECT_TRUE(stands_still(robot));
}

TEST_P(LastResort, IsHeldByASilenceThatSaysSo) {
  TestRobot robot = driving(loc_lost());
  robot.order({1, "Ann", "", Silence{RuleId(0), 10s}});
  EXPECT_EQ(robot.count("this holds back the last resort LocLost.stand_still"), 1u);
  robot.fail("loc", "a person", 8s);
  EXPECT_FALSE(stands_still(robot));
  robot.run_for(4s);
  EXPECT_TRUE(stands_still(robot));
}

TEST_P(LastResort, IsOnlySaidInADryRun) {
  Manager::Options options;
  options.autonomy = Autonomy::kAdvise;
  TestRobot robot = driving(loc_lost(), options);
  robot.fail("loc", "a person", 10s);
  EXPECT_TRUE(robot.asked.empty());
  EXPECT_EQ(robot.count("stand_still, "), 1u);
}

TEST_P(LastResort, MayBeOrderedDespiteAnInterlock) {
  TestRobot robot = driving("INTERLOCK speed < 0.1\n" + loc_lost());
  robot.signal("speed", Value(1.0));
  robot.order({1, "Ann", "", RunStrategy{StrategyId(1)}}, 1s);
  EXPECT_TRUE(stands_still(robot));
}

}  // namespace
}  // namespace culprit::test
