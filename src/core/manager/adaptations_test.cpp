#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "manager/test_robot.h"

namespace culprit::test {
namespace {

constexpr const char* kGain = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Dark
  POLICIES WARNING
  TRIGGER brightness < 0.5
    STRATEGY brighten 90 10
      ADAPTATION camera set_parameter gain 2 2
    STRATEGY more 50 10
      ADAPTATION camera increase_parameter exposure 1 2
)";

TestRobot dark_camera() {
  TestRobot robot(kGain);
  TestRobot::Component& camera = robot.add("camera");
  camera.parameters = {{"gain", Value(1.0)}, {"exposure", Value(std::int64_t{5})}};
  robot.discover();
  robot.signal("brightness", Value(1.0), 1s);
  return robot;
}

TEST(Manager, ProvesAParameterByReadingItBack) {
  TestRobot robot = dark_camera();
  robot.signal("brightness", Value(0.2), 100ms);
  EXPECT_EQ(robot.asked,
            (std::vector<std::string>{"camera: read parameter gain", "camera: set gain to 2.0",
                                      "camera: read parameter gain"}));
  robot.signal("brightness", Value(0.9), 1s);
  EXPECT_EQ(robot.count("Dark resolved by brighten"), 1u);
}

TEST(Manager, IncreasesAParameterByNumbersOfBothKinds) {
  for (const auto& [by, after] : {std::pair{"0.5", 1.5}, std::pair{"2", 3.0}}) {
    TestRobot robot(
        "COMPONENT camera NODE /camera\nRULE Dark\n  POLICIES WARNING\n  TRIGGER light < 0.5\n"
        "    STRATEGY more 90 10\n      ADAPTATION camera increase_parameter gain " +
        std::string(by) + " 5\n");
    robot.add("camera").parameters = {{"gain", Value(1.0)}};
    robot.discover();
    robot.signal("light", Value(1.0), 6s);
    robot.signal("light", Value(0.2), 300ms);
    EXPECT_EQ(robot["camera"].parameters["gain"], Value(after));
  }
}

TEST(Manager, UndoesAStrategyThatFailedBeforeTheNext) {
  TestRobot robot = dark_camera();
  robot.signal("brightness", Value(0.2), 3s);
  EXPECT_EQ(robot["camera"].parameters["gain"], Value(1.0));
  EXPECT_EQ(robot["camera"].parameters["exposure"], Value(std::int64_t{6}));
  const auto place = [&](const std::string& line) {
    return std::find(robot.asked.begin(), robot.asked.end(), line) - robot.asked.begin();
  };
  EXPECT_LT(place("camera: set gain to 1.0"), place("camera: set exposure to 6"));
}

// The journal names the adaptation with each request, and reads it back after a crash.
TEST(Manager, UndoesInTheNameOfAnAdaptationOfTheStrategy) {
  TestRobot robot = dark_camera();
  std::size_t undone = 0;
  robot.before_commands = [&](std::vector<Observation>&, std::span<const Command> commands) {
    for (const Command& command : commands) {
      const auto& adaptations = robot.rules()[command.purpose.strategy].adaptations;
      EXPECT_LT(command.purpose.adaptation, adaptations.size()) << to_string(command);
      if (command.purpose.undoes) ++undone;
    }
    return true;
  };
  robot.signal("brightness", Value(0.2), 3s);
  EXPECT_GE(undone, 1u);
}

// The filter is for the fusion that reads what it sends: both are as before, or neither.
constexpr const char* kFiltered = R"(
COMPONENT fusion NODE /fusion LAUNCH "fusion"
COMPONENT filter NODE /filter LAUNCH "filter"
RULE FusionDead
  POLICIES ERROR
  TRIGGER !alive(fusion)
    STRATEGY again 90 10
      ADAPTATION fusion redeploy 5
RULE FilterDead
  POLICIES WARNING
  TRIGGER !alive(filter)
    STRATEGY filter_again 90 10
      ADAPTATION filter redeploy 5
RULE Unsure
  POLICIES WARNING
  TRIGGER quality < 0.5
    STRATEGY filtered 90 10
      ADAPTATION filter activate 2
      ADAPTATION fusion change_communication input /filtered 2
)";

// Even if a value was to be undone while its process was not there: many nodes keep their
// parameters when they are started again, and culprit brings them to their intended values.
TEST(Manager, UndoesWhatItSetInAProcessThatIsGoneOnceThatIsBack) {
  for (const char* victim : {"fusion", "filter"}) {
    for (Duration killed = 0s; killed < 3s; killed += 50ms) {
      TestRobot robot(kFiltered);
      robot.add("fusion").parameters = {{"input", Value(std::string("/raw"))}};
      TestRobot::Component& filter = robot.add("filter");
      filter.state = filter.state_at_start = Lifecycle::kInactive;
      robot.discover();
      robot.signal("quality", Value(1.0), 6s);
      robot.signal("quality", Value(0.2), killed);
      robot.kill(victim, 40s);
      EXPECT_TRUE(robot.works("fusion"));
      const bool is_filtered =
          robot["fusion"].parameters["input"] == Value(std::string("/filtered"));
      EXPECT_EQ(robot["filter"].state == Lifecycle::kActive, is_filtered)
          << victim << " was killed after " << to_string(killed);
    }
  }
}

// A person brings it back and changes the parameter: a redeploy much later leaves that alone.
TEST(Manager, DoesNotUndoWhatItSetInAProcessThatSomebodyElseStartedAgain) {
  int forgotten = 0;
  for (Duration killed = 0s; killed < 3s; killed += 50ms) {
    TestRobot robot(R"(
COMPONENT fusion NODE /fusion LAUNCH "fusion"
COMPONENT filter NODE /filter LAUNCH "filter"
RULE Unsure
  POLICIES WARNING
  TRIGGER quality < 0.5
    STRATEGY filtered 90 10
      ADAPTATION fusion change_communication input /filtered 2
      ADAPTATION filter activate 2
RULE Wrong
  POLICIES ERROR
  TRIGGER is_wrong
    STRATEGY again 90 10
      ADAPTATION fusion redeploy 5
)");
    robot.add("fusion").parameters = {{"input", Value(std::string("/raw"))}};
    robot.add("filter").fails_to_activate = true;
    robot["filter"].state = robot["filter"].state_at_start = Lifecycle::kInactive;
    robot.discover();
    robot.signal("quality", Value(1.0));
    robot.signal("is_wrong", Value(false), 6s);
    robot.signal("quality", Value(0.2), killed);
    robot.kill("fusion", 3s);
    robot.signal("quality", Value(1.0));
    robot.start_by_hand("fusion", 5s);
    robot["fusion"].parameters["input"] = Value(std::string("/mine"));
    robot.signal("is_wrong", Value(true), 10s);
    EXPECT_TRUE(robot.was_asked("fusion: start"));
    EXPECT_EQ(robot["fusion"].parameters["input"], Value(std::string("/mine")));
    forgotten += robot.count("cannot be undone: fusion: input = ") == 1 ? 1 : 0;
  }
  EXPECT_GT(forgotten, 0);
}

TEST(Manager, SettlesALostReplyByReadingBack) {
  TestRobot robot = dark_camera();
  robot["camera"].loses_replies = true;
  robot.signal("brightness", Value(0.2), 1500ms);
  robot.signal("brightness", Value(0.9), 1s);
  EXPECT_EQ(robot.count_asked("set gain"), 1u) << "nothing is sent twice";
  EXPECT_EQ(robot.count("Dark resolved by brighten"), 1u);
}

TEST(Manager, IsNotHeldUpByAnAnswerThatComesWhenNobodyWaitsForItAnyMore) {
  TestRobot robot = dark_camera();
  robot["camera"].lateness = 1050ms;  // after the manager's own time-out, before its next look
  robot.after_step = [&] { robot["camera"].answers = !robot.was_asked("set gain"); };
  robot.signal("brightness", Value(0.2), 20s);
  EXPECT_EQ(robot.count("Dark is exhausted"), 1u);
}

TEST(Manager, NoticesAParameterThatIsAcceptedAndIgnored) {
  TestRobot robot = dark_camera();
  robot["camera"].ignores_parameters = true;
  robot.signal("brightness", Value(0.2), 1s);
  EXPECT_EQ(robot.count("accepted, but it reads back 1.0"), 1u);
}

TEST(Manager, GoesOnWhenAParameterIsRefusedOrUnknown) {
  TestRobot robot = dark_camera();
  robot["camera"].parameters.erase("gain");
  robot.signal("brightness", Value(0.2), 1s);
  EXPECT_EQ(robot.count("set gain of camera: failed, no parameter gain"), 1u);
  EXPECT_TRUE(robot.was_asked("set exposure to 6"));
}

// The process came anew by itself, and unconfigured: `respawn` in a launch file.
TEST(Manager, BringsWhatSomebodyElseRelaunchedBackToWhereItWas) {
  TestRobot robot(R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE CameraDead
  POLICIES ERROR
  TRIGGER age(/rgb) > 500ms
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 2
)");
  robot.add("camera", {}, "/rgb").state_at_start = Lifecycle::kUnconfigured;
  robot.discover(2s);
  robot["camera"].state = Lifecycle::kUnconfigured;
  robot["camera"].pid = 90;
  robot.tell(NodeAppeared{"/camera", 90});
  robot.tell(LifecycleRead{ComponentId(0), Lifecycle::kUnconfigured}, 10s);
  EXPECT_TRUE(robot.works("camera"));
}

// As with run --launch.
TEST(Manager, StartsAComponentThatIsNotThereAndCountsAsSeen) {
  TestRobot robot(R"(
COMPONENT camera NODE /camera LAUNCH "camera"
RULE Missing
  POLICIES ERROR
  TRIGGER !alive(camera) || age(/rgb) > 1s
    STRATEGY start 90 10
      ADAPTATION camera start 5
)");
  robot.add("camera", {}, "/rgb").process = ProcessState::kGone;
  robot.manager().remember(KnownRobot{{{"camera", "/camera", {}}}, {"/rgb"}});
  robot.run_for(4s);
  EXPECT_TRUE(robot.said.empty()) << "discovery may still be under way";
  robot.run_for(10s);
  EXPECT_EQ(robot.count("Missing resolved by start"), 1u);
}

}  // namespace
}  // namespace culprit::test
