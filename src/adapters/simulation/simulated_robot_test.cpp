#include "simulation/simulated_robot.h"

#include <atomic>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "knowledge/describe.h"
#include "language/checker.h"
#include "manager/manager.h"
#include "manager/runtime.h"
#include "plan/paper_planner.h"
#include "simulation/fault.h"
#include "simulation/topic.h"

namespace culprit::simulation {
namespace {

using namespace std::chrono_literals;

constexpr const char* kSimulatedRules =
    "COMPONENT camera NODE /camera LAUNCH \"camera\"\n"
    "RULE CameraDead\n"
    "  POLICIES ERROR\n"
    "  TRIGGER age(/image) > 350ms\n"
    "    STRATEGY restart 50 10\n"
    "      ADAPTATION camera restart 3\n"
    "    STRATEGY redeploy 90 10\n"
    "      ADAPTATION camera redeploy 10\n"
    "RULE TooDark\n"
    "  POLICIES WARNING\n"
    "  TRIGGER brightness < 0.5\n"
    "    STRATEGY expose 50 10\n"
    "      ADAPTATION camera set_parameter exposure 1.0 3\n";

NodeTraits camera_traits() {
  NodeTraits traits;
  traits.start = {300ms, {}};
  traits.service = {2ms, 1ms};
  return traits;
}

class Camera : public Node {
 public:
  Camera(World& world, Topic<int>& images)
      : Node(world, "/camera", camera_traits()), images_(*this, images) {
    declare("broken", false);  // a restart repairs it
    declare("burnt", false);   // a new process does
    declare("exposure", 1.0);
  }

 private:
  void on_activate() override { assign("broken", false); }
  void on_start() override {
    every(100ms, [this] {
      world().diagnose("camera", "brightness", *parameter("exposure"));
      if (*parameter("broken") == Value(false) && *parameter("burnt") == Value(false))
        images_.publish(1);
    });
  }
  Publisher<int> images_;
};

struct Robot {
  explicit Robot(std::uint64_t seed = 1)
      : world(seed), images(world, "/image"), camera(world, images) {
    camera.launch();
    world.run(Time{1s});
  }
  World world;
  Topic<int> images;
  Camera camera;
};

std::string managed(Robot& robot, Duration time) {
  const Source source("camera.rules", kSimulatedRules);
  const RuleSet rules = *check(source).rules;
  Manager::Options options;
  options.start = robot.world.now();
  options.discovery = 100ms;
  Manager manager(rules, std::make_unique<PaperPlanner>(), options);
  SimulatedRobot adapter(rules, robot.world);
  Runtime runtime(manager, adapter);
  std::string said;
  runtime.on_events = [&](std::span<const Event> events) {
    for (const Event& event : events) {
      said +=
          std::to_string(event.at.time_since_epoch() / 1ns) + " " + describe(event, rules) + "\n";
    }
  };
  const std::atomic<bool> never = false;
  runtime.run(never, later(robot.world.now(), time));
  return said;
}

bool has(const Node& node, const char* parameter, const Value& value) {
  return *node.parameter(parameter) == value;
}

TEST(SimulatedRobot, IsHealedByARestart) {
  Robot robot;
  ASSERT_TRUE(inject(robot.world, {Time{2s}, "/camera", BadParameter{"broken", true}}));
  const std::string said = managed(robot, 5s);
  EXPECT_THAT(said, testing::HasSubstr("CameraDead resolved by restart"));
  EXPECT_TRUE(has(robot.camera, "broken", false));
}

TEST(SimulatedRobot, IsHealedByARedeployment) {
  Robot robot;
  const int pid = robot.camera.pid();
  ASSERT_TRUE(inject(robot.world, {Time{2s}, "/camera", BadParameter{"burnt", true}}));
  const std::string said = managed(robot, 10s);
  EXPECT_THAT(said, testing::HasSubstr("restart did not resolve CameraDead"));
  EXPECT_THAT(said, testing::HasSubstr("CameraDead resolved by redeploy"));
  EXPECT_NE(robot.camera.pid(), pid);
}

TEST(SimulatedRobot, IsHealedOfAKilledAndOfAHungProcess) {
  for (const auto& fault :
       {Fault{Time{2s}, "/camera", Killed{}}, Fault{Time{2s}, "/camera", Hung{}}}) {
    Robot robot;
    ASSERT_TRUE(inject(robot.world, fault));
    EXPECT_THAT(managed(robot, 30s), testing::HasSubstr("CameraDead resolved by redeploy"));
  }
}

TEST(SimulatedRobot, ShowsDiagnosticsAndTakesParameters) {
  Robot robot;
  ASSERT_TRUE(inject(robot.world, {Time{2s}, "/camera", BadParameter{"exposure", 0.1}}));
  EXPECT_THAT(managed(robot, 5s), testing::HasSubstr("TooDark resolved by expose"));
  EXPECT_TRUE(has(robot.camera, "exposure", 1.0));
}

TEST(SimulatedRobot, IsTheSameForTheSameSeed) {
  const auto run = [](std::uint64_t seed) {
    Robot robot(seed);
    EXPECT_TRUE(inject(robot.world, {Time{2s}, "/camera", BadParameter{"burnt", true}}));
    return managed(robot, 10s);
  };
  EXPECT_EQ(run(7), run(7));
  EXPECT_NE(run(7), run(8));  // the services take other times
}

// ---- commands

std::vector<Reply> replies(Robot& robot, Command command, Duration time = 3s) {
  const Source source("camera.rules", kSimulatedRules);
  const RuleSet rules = *check(source).rules;
  SimulatedRobot adapter(rules, robot.world);
  command.id = {1};
  command.timeout = 1s;
  adapter.execute(command);
  std::vector<Observation> observations;
  const Time end = later(robot.world.now(), time);
  while (robot.world.now() < end) adapter.observe(end, observations);
  std::vector<Reply> out;
  for (const Observation& o : observations) {
    if (const auto* reply = std::get_if<Reply>(&o.what)) out.push_back(*reply);
  }
  return out;
}

TEST(SimulatedRobot, AnswersEachCommandOnce) {
  Robot robot;
  for (const Command& command :
       {Command{{}, {}, ReadLifecycle{}}, Command{{}, {}, ReadParameter{"exposure"}},
        Command{{}, {}, SetParameter{"exposure", 0.5}}, Command{{}, {}, StopProcess{}},
        Command{{}, {}, StartProcess{}}}) {
    const auto got = replies(robot, command);
    ASSERT_EQ(got.size(), 1) << to_string(command);
    EXPECT_EQ(got[0].outcome, Outcome::kDone) << to_string(command);
  }
}

TEST(SimulatedRobot, RefusesWhatIsNotPossible) {
  Robot robot;
  for (const Command& command :
       {Command{{}, {}, ReadParameter{"colour"}}, Command{{}, {}, SetParameter{"exposure", true}},
        Command{{}, {}, ChangeLifecycle{Transition::kActivate}},
        Command{{}, {}, CallService{"/camera/focus"}}, Command{{}, {}, ReadMode{}}}) {
    const auto got = replies(robot, command);
    ASSERT_EQ(got.size(), 1) << to_string(command);
    EXPECT_EQ(got[0].outcome, Outcome::kRefused) << to_string(command);
  }
}

TEST(SimulatedRobot, AHungNodeLetsARequestTimeOut) {
  Robot robot;
  robot.camera.hang();
  const auto got = replies(robot, {{}, {}, ReadLifecycle{}});
  ASSERT_EQ(got.size(), 1);
  EXPECT_EQ(got[0].outcome, Outcome::kTimedOut);
}

TEST(SimulatedRobot, ANodeThatIsNotThereCannotBeReached) {
  Robot robot;
  robot.camera.terminate([] {});
  robot.world.run(Time{2s});
  const auto got = replies(robot, {{}, {}, ReadLifecycle{}});
  ASSERT_EQ(got.size(), 1);
  EXPECT_EQ(got[0].outcome, Outcome::kUnreachable);
}

}  // namespace
}  // namespace culprit::simulation
