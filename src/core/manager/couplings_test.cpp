#include <memory>

#include <gtest/gtest.h>

#include "manager/test_pipeline.h"
#include "manager/test_robot.h"
#include "plan/paper_planner.h"

namespace culprit::test {
namespace {

Coupling coupling(TestRobot& robot, std::size_t cause, std::size_t effect) {
  return robot.manager().knowledge().couplings.of(RuleId(cause), RuleId(effect));
}

TEST(Couplings, LearnWhichFailuresGoAwayWithTheOneThatWasRepaired) {
  TestRobot robot = pipeline(std::make_unique<BayesPlanner>());
  robot.fail("camera", "restart", 10s);
  EXPECT_EQ(coupling(robot, 0, 1), (Coupling{1, 0}));
  EXPECT_EQ(coupling(robot, 0, 2), (Coupling{1, 0}));
  EXPECT_EQ(coupling(robot, 1, 2), Coupling()) << "the camera was repaired, not the fusion";
}

TEST(Couplings, LearnWhichStay) {
  TestRobot robot = pipeline(std::make_unique<BayesPlanner>());
  robot["camera"].fault = "restart";
  robot.fail("fusion", "restart", 20s);
  EXPECT_TRUE(robot.works("segmentation"));
  EXPECT_EQ(coupling(robot, 0, 1), (Coupling{0, 1}));
  EXPECT_EQ(coupling(robot, 1, 2), (Coupling{1, 0}));
}

TEST(Couplings, LearnNothingFromOutcomesWithTwoCauses) {
  TestRobot robot = pipeline(std::make_unique<PaperPlanner>(PaperSwitches{.dependencies = false}));
  robot["camera"].fault = "restart";  // all three are restarted
  robot.run_for(10s);
  for (std::size_t cause = 0; cause < 3; ++cause) {
    for (std::size_t effect = 0; effect < 3; ++effect)
      EXPECT_EQ(coupling(robot, cause, effect), Coupling());
  }
}

TEST(Couplings, LearnThatAStrategyClearsAFailureThatIsNotDownstream) {
  TestRobot robot(R"(
COMPONENT camera NODE /camera
COMPONENT lamp   NODE /lamp
RULE Dark
  POLICIES WARNING
  TRIGGER brightness < 0.5
    STRATEGY light 90 10
      ADAPTATION lamp set_parameter on 1 2
RULE Blurred
  POLICIES NON_CRITICAL
  TRIGGER blur > 0.5
    STRATEGY focus 50 10
      ADAPTATION lamp set_parameter angle 1 2
)");
  robot.add("camera");
  robot.add("lamp").parameters = {{"on", Value(std::int64_t{0})},
                                  {"angle", Value(std::int64_t{0})}};
  robot.discover();
  for (const double brightness : {1.0, 1.0, 0.2}) {
    robot.signal("brightness", Value(brightness));
    robot.signal("blur", Value(1 - brightness), 300ms);
  }
  robot.signal("brightness", Value(1.0));
  robot.signal("blur", Value(0.0), 3s);
  EXPECT_EQ(robot.count("Dark resolved by light"), 1u);
  EXPECT_EQ(coupling(robot, 0, 1), (Coupling{1, 0}));
}

// A reading comes every two seconds: the next one decides, and not the next cycle.
TEST(Couplings, WaitForTheReadingsOfTheEffect) {
  TestRobot robot(R"(
COMPONENT lamp   NODE /lamp
RULE Dark
  POLICIES WARNING
  TRIGGER brightness < 0.5
    STRATEGY light 90 10
      ADAPTATION lamp set_parameter on 1 2
RULE Blurred
  POLICIES NON_CRITICAL
  TRIGGER blur > 0.5
    STRATEGY focus 50 10
      ADAPTATION lamp set_parameter angle 1 2
)");
  robot.add("lamp").parameters = {{"on", Value(std::int64_t{0})},
                                  {"angle", Value(std::int64_t{0})}};
  robot.discover();
  for (int tenth = 0; tenth < 120; ++tenth) {
    robot.signal("brightness", Value(tenth >= 80 && tenth < 83 ? 0.2 : 1.0));
    if (tenth % 20 == 0) robot.signal("blur", Value(tenth == 80 ? 1.0 : 0.0));
    robot.run_for(100ms);
  }
  EXPECT_EQ(robot.count("Dark resolved by light"), 1u);
  EXPECT_EQ(coupling(robot, 0, 1), (Coupling{1, 0}));
}

}  // namespace
}  // namespace culprit::test
