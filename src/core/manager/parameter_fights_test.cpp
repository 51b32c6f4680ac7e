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

TEST_P(ParameterFight, EndsWithTheValueOfTheMoreCriticalRule) {
  Fight fight(GetParam()(), "WARNING");
  fight.run_for(300s);
  EXPECT_LE(fight.changes(), 3u) << transcript(fight.robot);
  EXPECT_EQ(fight.robot["cam"].parameters["gain"], Value(3.0)) << transcript(fight.robot);
  EXPECT_EQ(fight.robot.count("TooNoisy is exhausted"), 1u) << transcript(fight.robot);
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
  EXPECT_LE(fight.changes(), 3u) << transcript(fight.robot);
  EXPECT_EQ(fight.robot.count("TooNoisy is exhausted"), 1u) << transcript(fight.robot);
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
  EXPECT_GT(fight.changes(), before) << transcript(fight.robot);
}

}  // namespace
}  // namespace culprit::test
