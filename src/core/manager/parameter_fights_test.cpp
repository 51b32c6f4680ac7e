// Two rules that want one parameter at different values: the more critical one's value stays.
#include <gtest/gtest.h>

#include "manager/test_robot.h"
#include "plan/paper_planner.h"

namespace culprit::test {
namespace {

std::unique_ptr<const Planner> fight_paper() { return std::make_unique<PaperPlanner>(); }
std::unique_ptr<const Planner> fight_bayes() { return std::make_unique<BayesPlanner>(); }

class ParameterFight : public testing::TestWithParam<PlannerFactory> {};
INSTANTIATE_TEST_SUITE_P(EachPlanner, ParameterFight, testing::Values(fight_paper, fight_bayes),
                         [](const auto& test) { return test.index == 0 ? "paper" : "bayes"; });

// Each value spoils the other's signal.
struct Fight {
  Fight(std::unique_ptr<const Planner> planner, const std::string& lesser)
      : robot(
            "COMPONENT cam NODE /cam LAUNCH \"cam\"\n"
            "RULE TooDark\nPOLICIES ERROR\nTRIGGER light < 2\nSTRATEGY more 90 10\n"
            "ADAPTATION cam set_parameter gain 3.0 3\nRULE TooNoisy\nPOLICIES " +
                lesser +
                "\nTRIGGER noise > 2.5\nSTRATEGY less 90 10\n"
                "ADAPTATION cam set_parameter gain 1.0 3\n",
            std::move(planner)) {
    robot.add("cam").parameters["gain"] = Value(1.5);
    robot.discover();
  }
  void run_for(Duration time) {
    for (const Time end = robot.now + time; robot.now < end; robot.run_for(100ms)) {
      const double gain = std::get<double>(robot["cam"].parameters["gain"]);
      robot.signal("light", Value(gain));
      robot.signal("noise", Value(gain));
    }
  }
  std::size_t changes() const { return robot.count_asked("cam: set gain"); }
  TestRobot robot;
  Value last;
};

// A battery that is emptied by work, and charged by people.
struct Charged {
  explicit Charged(std::unique_ptr<const Planner> planner)
      : robot(
            "COMPONENT base NODE /base LAUNCH \"base\"\n"
            "RULE Low\nPOLICIES ERROR ON_CHANGE\nTRIGGER charge < 0.1\nSTRATEGY rest 90 10\n"
            "ADAPTATION base set_parameter power false 2\n"
            "RULE Full\nPOLICIES NON_CRITICAL\nTRIGGER rests && charge > 0.9\n"
            "STRATEGY go 90 10\nADAPTATION base set_parameter power true 2\n",
            std::move(planner)) {
    robot.add("base").parameters["power"] = Value(true);
    robot.discover();
  }
  bool has_power() { return robot["base"].parameters["power"] == Value(true); }
  void run_for(Duration time, double charge) {
    for (const Time end = robot.now + time; robot.now < end; robot.run_for(1s)) {
      robot.signal("charge", Value(charge));
      robot.signal("rests", Value(!has_power()));
    }
  }
  TestRobot robot;
};

TEST_P(ParameterFight, EndsWithTheValueOfTheMoreCriticalRule) {
  Fight fight(GetParam()(), "WARNING");
  fight.run_for(300s);
  EXPECT_LE(fight.changes(), 3u);
  EXPECT_EQ(fight.robot["cam"].parameters["gain"], Value(3.0));
  EXPECT_EQ(fight.robot.count("TooNoisy is exhausted"), 1u);
}

// The failure is back before the other's change was read back.
TEST_P(ParameterFight, IsSeenHoweverSoonTheFailureIsBack) {
  Fight fight(GetParam()(), "WARNING");
  fight.robot.after_step = [&] {
    const auto& gain = fight.robot["cam"].parameters["gain"];
    if (fight.last == gain) return;
    fight.last = gain;
    fight.robot.signal("light", gain);
    fight.robot.signal("noise", gain);
  };
  fight.run_for(300s);
  EXPECT_LE(fight.changes(), 3u);
  EXPECT_EQ(fight.robot.count("TooNoisy is exhausted"), 1u);
}

// Its process keeps no parameters: a new process makes the memory of the old one's values void.
TEST_P(ParameterFight, BeginsAnewWithTheProcess) {
  Fight fight(GetParam()(), "WARNING");
  fight.run_for(60s);
  const std::size_t before = fight.changes();
  fight.robot.kill("cam");
  fight.run_for(10s);
  fight.robot["cam"].parameters["gain"] = Value(2.2);
  fight.robot.start_by_hand("cam");
  fight.run_for(90s);
  fight.robot["cam"].parameters["gain"] = Value(2.7);
  fight.run_for(20s);
  EXPECT_GT(fight.changes(), before);
}

TEST_P(ParameterFight, IsNotWhatComesAgainMuchLater) {
  Charged day(GetParam()());
  for (int shift = 0; shift < 4; ++shift) {
    day.run_for(1h, 1.0);
    EXPECT_TRUE(day.has_power()) << shift;
    day.run_for(10min, 0.05);
    EXPECT_FALSE(day.has_power()) << shift;
  }
}

}  // namespace
}  // namespace culprit::test
