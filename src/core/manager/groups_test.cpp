// Components that one lifecycle manager starts (GROUP): a group that was left half up is brought up past its
// manager, and a failure of a member is over only once its group is active.
#include <algorithm>

#include <gtest/gtest.h>

#include "manager/manager.h"
#include "manager/test_robot.h"

namespace culprit::test {
namespace {

// Three servers and their manager, each with a command. The group's rule waits 2 s.
std::string rules_of_group(const std::string& more = "",
                           const std::string& launch = "LAUNCH \"x\"") {
  std::string text;
  for (const std::string name : {"planner", "controller", "navigator", "manager"})
    text += "COMPONENT " + name + " NODE /" + name + " " +
            (launch.empty() ? "" : "LAUNCH \"" + name + "\"") +
            (name == "manager" ? "\n" : " LIFECYCLE launcher\n");
  return text +
         "GROUP navigation { planner, controller, navigator } MANAGER manager\n"
         "RULE HalfUp\n  POLICIES ERROR FOR 2s\n"
         "  TRIGGER navigation == \"half_up\" || navigation == \"down\"\n"
         "    STRATEGY start_navigation 80 10\n      ADAPTATION navigation start_group 25\n" +
         more;
}

std::string gone_rule(const std::string& name) {
  return "RULE " + name + "_gone\n  POLICIES ERROR\n  TRIGGER !alive(" + name + ")\n    STRATEGY " +
         name + "_again 85 10\n      ADAPTATION " + name + " redeploy 25\n";
}

TestRobot robot_with_group(const std::string& rules) {
  TestRobot robot(rules);
  for (const char* name : {"planner", "controller", "navigator"})
    robot.add(name).state_at_start = Lifecycle::kUnconfigured;
  robot.add("manager").has_lifecycle = false;
  robot.discover(10s);
  return robot;
}

void put(TestRobot& robot, const std::string& name, Lifecycle state) {
  robot[name].state = state;
  robot.tell(LifecycleRead{robot.id(name), state});
}

bool is_active(TestRobot& robot, const std::string& name) {
  return robot[name].state == Lifecycle::kActive;
}

bool are_active(TestRobot& robot) {
  return is_active(robot, "planner") && is_active(robot, "controller") &&
         is_active(robot, "navigator");
}

std::size_t place_asked(const TestRobot& robot, const std::string& what) {
  const auto found = std::ranges::find(robot.asked, what);
  return static_cast<std::size_t>(found - robot.asked.begin());
}

TEST(Groups, OneThatIsWellIsLeftAlone) {
  TestRobot robot = robot_with_group(rules_of_group());
  robot.run_for(60s);
  EXPECT_EQ(robot.count("HalfUp"), 0u);
}

TEST(Groups, OneThatIsHalfUpIsDrivenUpInItsOrderAndItsManagerBegunAnew) {
  TestRobot robot = robot_with_group(rules_of_group());
  put(robot, "controller", Lifecycle::kUnconfigured);
  put(robot, "navigator", Lifecycle::kInactive);
  robot.run_for(12s);
  EXPECT_TRUE(are_active(robot));
  EXPECT_FALSE(robot.was_asked("planner: activate"));
  EXPECT_LT(place_asked(robot, "controller: configure"),
            place_asked(robot, "controller: activate"));
  EXPECT_LT(place_asked(robot, "controller: activate"), place_asked(robot, "navigator: activate"));
  EXPECT_LT(place_asked(robot, "navigator: activate"),
            place_asked(robot, "manager: start process"));
  EXPECT_EQ(robot.count("HalfUp resolved by start_navigation"), 1u);
}

TEST(Groups, OfAGroupThatIsHalfUpTheFirstMemberThatIsNotUpIsBlamed) {
  TestRobot robot = robot_with_group(rules_of_group());
  put(robot, "navigator", Lifecycle::kInactive);
  robot.run_for(12s);
  std::vector<ComponentId> blamed;
  for (const Event& event : robot.events) {
    if (const auto* chosen = std::get_if<StrategyChosen>(&event.what))
      blamed.push_back(chosen->suspects.front().component);
  }
  EXPECT_EQ(blamed, std::vector{robot.id("navigator")});
}

TEST(Groups, AManagerThatResetsIsBusyAndLeftAlone) {
  TestRobot robot = robot_with_group(rules_of_group());
  // One server after the other, each taking its time, and up again.
  for (const Lifecycle state :
       {Lifecycle::kInactive, Lifecycle::kUnconfigured, Lifecycle::kInactive, Lifecycle::kActive}) {
    for (const char* name : {"navigator", "controller", "planner"}) {
      put(robot, name, state);
      robot.run_for(3s);
    }
  }
  robot.run_for(30s);
  EXPECT_EQ(robot.count("HalfUp"), 0u);
}

TEST(Groups, OneThatAPersonPausedStaysPaused) {
  TestRobot robot = robot_with_group(rules_of_group());
  for (const char* name : {"navigator", "controller", "planner"})
    put(robot, name, Lifecycle::kInactive);
  robot.run_for(60s);
  EXPECT_TRUE(robot.asked.empty());
}

TEST(Groups, AMemberThatDiesDuringAPauseIsReplacedAndThePauseLasts) {
  TestRobot robot = robot_with_group(rules_of_group(gone_rule("planner")));
  for (const char* name : {"navigator", "controller", "planner"})
    put(robot, name, Lifecycle::kInactive);
  robot.run_for(10s);
  robot.kill("planner", 60s);
  EXPECT_EQ(robot.count_asked("planner: start"), 1u);
  EXPECT_FALSE(robot.was_asked("controller: "));
  // The pause ends, and the manager cannot activate the new one.
  for (const char* name : {"controller", "navigator"}) put(robot, name, Lifecycle::kActive);
  robot.run_for(15s);
  EXPECT_TRUE(are_active(robot));
}

TEST(Groups, AMemberThatDiedIsStarted) {
  TestRobot robot = robot_with_group(rules_of_group());
  robot.kill("planner");
  put(robot, "navigator", Lifecycle::kInactive);
  robot.run_for(20s);
  EXPECT_TRUE(are_active(robot));
  EXPECT_EQ(robot.count_asked("planner: start"), 1u);
}

TEST(Groups, AMemberThatHangsIsReplaced) {
  TestRobot robot = robot_with_group(rules_of_group());
  robot.stop("controller");
  put(robot, "navigator", Lifecycle::kInactive);
  robot.run_for(40s);
  EXPECT_TRUE(are_active(robot));
  EXPECT_EQ(robot.count_asked("controller: start"), 1u);
}

// Another of its threads still works, so that its topics come and it is not found to hang.
void hang_unnoticed(TestRobot& robot, const std::string& name) {
  robot.tell(Probed{robot.id(name), true});
  robot[name].answers = false;
}

TEST(Groups, AMemberThatHangsUnnoticedIsReplacedAsAPartOfTheRepair) {
  TestRobot robot = robot_with_group(rules_of_group());
  hang_unnoticed(robot, "controller");
  put(robot, "navigator", Lifecycle::kInactive);
  robot.run_for(20s);
  EXPECT_TRUE(are_active(robot));
  EXPECT_EQ(robot.count_asked("controller: start"), 1u);
  EXPECT_FALSE(robot.was_asked("planner: start"));
  EXPECT_FALSE(robot.was_asked("navigator: start"));
  EXPECT_EQ(robot.count("HalfUp resolved by start_navigation"), 1u);
}

TEST(Groups, AMemberThatIsBusyInATransitionIsNotReplaced) {
  TestRobot robot = robot_with_group(rules_of_group());
  hang_unnoticed(robot, "controller");
  put(robot, "navigator", Lifecycle::kInactive);
  robot.tell(LifecycleRead{robot.id("controller"), Lifecycle::kTransition}, 8s);
  robot["controller"].answers = true;
  put(robot, "controller", Lifecycle::kActive);
  robot.run_for(20s);
  EXPECT_TRUE(are_active(robot));
  EXPECT_FALSE(robot.was_asked("controller: start"));
}

TEST(Groups, AMemberThatNeverAnsweredIsNotTakenForHung) {
  TestRobot robot = robot_with_group(rules_of_group());
  robot["controller"].answers = false;
  put(robot, "navigator", Lifecycle::kInactive);
  robot.run_for(20s);
  EXPECT_FALSE(robot.was_asked("controller: stop"));
  EXPECT_FALSE(robot.was_asked("controller: start"));
}

TEST(Groups, WithoutACommandADeadMemberIsLeftToAPerson) {
  TestRobot robot = robot_with_group(rules_of_group("", ""));
  robot.kill("planner", 5min);
  EXPECT_TRUE(robot.asked.empty());
  EXPECT_GE(robot.count("HalfUp"), 1u);
}

TEST(Groups, OneWhoseManagerCannotBeStartedIsDrivenUpAllTheSame) {
  TestRobot robot = robot_with_group(rules_of_group("", ""));
  put(robot, "controller", Lifecycle::kInactive);
  robot.run_for(20s);
  EXPECT_TRUE(are_active(robot));
  EXPECT_FALSE(robot.was_asked("manager: "));
}

TEST(Groups, AMemberThatRefusesIsReportedAndTheOthersStayUp) {
  TestRobot robot = robot_with_group(rules_of_group());
  robot["navigator"].refuses = true;
  put(robot, "controller", Lifecycle::kInactive);
  put(robot, "navigator", Lifecycle::kInactive);
  robot.run_for(10min);
  EXPECT_TRUE(is_active(robot, "controller"));
  EXPECT_FALSE(robot.was_asked("controller: deactivate"));
  EXPECT_FALSE(robot.was_asked("manager: "));
  EXPECT_GE(robot.count("it refused to activate"), 1u);
}

TEST(Groups, WhatSomebodyDeactivatesMeanwhileIsNotActivatedAgain) {
  TestRobot robot = robot_with_group(rules_of_group());
  put(robot, "planner", Lifecycle::kInactive);
  put(robot, "controller", Lifecycle::kInactive);
  put(robot, "navigator", Lifecycle::kUnconfigured);
  // A person pauses as soon as the first ones are up.
  bool has_paused = false;
  robot.after_step = [&] {
    if (has_paused || !robot.was_asked("navigator: ")) return;
    has_paused = true;
    for (const char* name : {"controller", "planner"}) put(robot, name, Lifecycle::kInactive);
    put(robot, "navigator", Lifecycle::kInactive);
  };
  robot.run_for(14s);
  EXPECT_TRUE(has_paused);
  EXPECT_EQ(robot.count_asked("planner: activate"), 1u);
  EXPECT_FALSE(robot.was_asked("manager: "));
}

TEST(Groups, NothingIsDoneWhileCulpritIsPaused) {
  TestRobot robot = robot_with_group(rules_of_group());
  robot.order({1, "a person", "", Pause{}});
  put(robot, "controller", Lifecycle::kInactive);
  robot.run_for(60s);
  EXPECT_TRUE(robot.asked.empty());
  robot.order({2, "a person", "", Resume{}}, 10s);
  EXPECT_TRUE(are_active(robot));
}

TEST(Groups, AMemberThatAPersonShutDownStaysDown) {
  TestRobot robot = robot_with_group(rules_of_group());
  robot["planner"].state = Lifecycle::kFinalized;
  robot.tell(LifecycleRead{robot.id("planner"), Lifecycle::kFinalized, true}, 60s);
  EXPECT_TRUE(robot.asked.empty());
}

TEST(Groups, ACulpritThatIsKilledMeanwhileLeavesNothingThatTheNextOneCannotFinish) {
  TestRobot robot = robot_with_group(rules_of_group());
  put(robot, "controller", Lifecycle::kInactive);
  put(robot, "navigator", Lifecycle::kInactive);
  robot.before_commands = [&](std::vector<Observation>&, std::span<const Command> commands) {
    return std::ranges::none_of(
        commands, [&](const Command& each) { return each.component == robot.id("navigator"); });
  };
  robot.run_for(9s);
  ASSERT_TRUE(is_active(robot, "controller"));
  robot.before_commands = nullptr;
  robot.replace_manager(std::make_unique<Manager>(robot.rules(), std::make_unique<BayesPlanner>(),
                                                  Manager::Options{.start = robot.now}));
  robot.run_for(20s);
  EXPECT_TRUE(are_active(robot));
}

// It is there again at once, and the manager has stopped at it: the failure is over when the group is up.
TEST(Groups, AMemberIsWellOnceItsGroupIs) {
  TestRobot robot = robot_with_group(rules_of_group(gone_rule("planner")));
  robot.kill("planner", 4s);
  EXPECT_EQ(robot.count_asked("planner: start"), 1u);
  EXPECT_EQ(robot.count("planner_gone") - robot.count("planner_again"), 1u);
  put(robot, "navigator", Lifecycle::kInactive);
  robot.run_for(3s);
  EXPECT_EQ(robot.count("resolved"), 0u);
  robot.run_for(10s);
  EXPECT_TRUE(are_active(robot));
  EXPECT_EQ(robot.count_asked("planner: start"), 1u);
  EXPECT_GE(robot.count("resolved"), 2u);
}

// The others depend on it, so that it explains why the group is half up. It is over only with the group.
TEST(Groups, AMemberThatHungDoesNotHoldUpWhatBringsUpItsGroup) {
  TestRobot robot = robot_with_group(rules_of_group(gone_rule("controller") +
                                                    "DEPENDENCY navigator ON controller planner\n"
                                                    "DEPENDENCY planner ON controller\n"));
  robot.stop("controller", 5s);
  for (const char* name : {"navigator", "planner"}) put(robot, name, Lifecycle::kInactive);
  robot.run_for(25s);
  EXPECT_EQ(robot.count_asked("controller: start"), 1u);
  EXPECT_TRUE(are_active(robot));
  EXPECT_EQ(robot.count("resolved"), 2u);
}

// Its manager brings it up in time.
TEST(Groups, AMemberWhoseManagerBringsItUpNeedsNoMore) {
  TestRobot robot = robot_with_group(rules_of_group(gone_rule("planner")));
  robot.kill("planner", 4s);
  put(robot, "planner", Lifecycle::kInactive);
  robot.run_for(1s);
  put(robot, "planner", Lifecycle::kActive);
  robot.run_for(60s);
  EXPECT_FALSE(robot.was_asked("planner: activate"));
  EXPECT_FALSE(robot.was_asked("manager: "));
  EXPECT_EQ(robot.count("resolved"), 1u);
}

}  // namespace
}  // namespace culprit::test
