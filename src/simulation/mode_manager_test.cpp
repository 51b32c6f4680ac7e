#include "simulation/mode_manager.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "language/checker.h"
#include "manager/manager.h"
#include "manager/runtime.h"
#include "plan/paper_planner.h"
#include "simulation/simulated_robot.h"

namespace culprit::simulation {
namespace {

using namespace std::chrono_literals;

// A lifecycle node with one parameter, that configures itself.
class Pump : public Node {
 public:
  explicit Pump(World& world) : Node(world, "/pump_node", traits_of()) {
    declare("rate", std::int64_t{0});
  }

 private:
  static NodeTraits traits_of() {
    NodeTraits traits;
    traits.starts_as = Lifecycle::kInactive;
    return traits;
  }
};

std::vector<ModeSystem> pump_modes() {
  const auto active = [](std::int64_t rate) {
    return std::vector<PartMode>{{"/pump_node", true, {{"rate", rate}}}};
  };
  return {{"/pump",
           {{"__DEFAULT__", active(1)},
            {"slow", active(1)},
            {"fast", active(9)},
            {"off", {{"/pump_node", false, {}}}}}}};
}

struct Plant {
  World world{1};
  Pump pump{world};
  ModeManager modes{world, "/modes", pump_modes(), {}};

  Plant() {
    for (Node* node : world.nodes()) node->launch();
    run(1s);
  }
  void run(Duration time) { world.run(later(world.now(), time)); }
  bool change(const std::string& mode) {
    const bool is_accepted = modes.change_mode("/pump", mode);
    run(1s);
    return is_accepted;
  }
  std::string mode() const { return modes.mode_of("/pump"); }
};

TEST(ModeManager, ActivatesThePartAndSetsItsParameters) {
  Plant plant;
  EXPECT_EQ(plant.mode(), "off");
  EXPECT_TRUE(plant.change("fast"));
  EXPECT_TRUE(plant.pump.is_active());
  EXPECT_EQ(*plant.pump.parameter("rate"), Value(std::int64_t{9}));
  EXPECT_EQ(plant.mode(), "fast");
  EXPECT_TRUE(plant.change("off"));
  EXPECT_EQ(plant.pump.lifecycle(), Lifecycle::kInactive);
  EXPECT_EQ(plant.mode(), "off");
}

TEST(ModeManager, AcceptsNoModeThatThereIsNot) {
  Plant plant;
  EXPECT_FALSE(plant.change("turbo"));
  EXPECT_EQ(plant.mode(), "off");
}

TEST(ModeManager, InfersTheModeThatWasAskedForWhereSeveralFit) {
  Plant plant;
  plant.change("slow");
  EXPECT_EQ(plant.mode(), "slow");
  plant.change("fast");
  plant.change("__DEFAULT__");
  EXPECT_EQ(plant.mode(), "__DEFAULT__");
}

TEST(ModeManager, KnowsNoModeOfWhatFitsNone) {
  Plant plant;
  plant.change("fast");
  plant.pump.set_parameter("rate", std::int64_t{5});
  plant.run(1s);
  EXPECT_EQ(plant.mode(), ModeManager::kUnknown);
}

TEST(ModeManager, SeesAPartThatBeganAnew) {
  Plant plant;
  plant.change("fast");
  plant.pump.kill();
  plant.run(1s);
  EXPECT_EQ(plant.mode(), "fast");  // nobody told it otherwise
  plant.pump.launch();
  plant.run(1s);
  EXPECT_EQ(plant.mode(), "off");
  EXPECT_TRUE(plant.change("fast"));
  EXPECT_EQ(plant.mode(), "fast");
}

TEST(ModeManager, AsksThePartsWhenItBeganAnewItself) {
  Plant plant;
  plant.change("fast");
  plant.modes.kill();
  plant.modes.launch();
  plant.run(1s);
  EXPECT_EQ(plant.mode(), "fast");
}

RC_GTEST_PROP(ModeManager, EndsInTheLastModeThatItAccepted, ()) {
  const auto wanted = *rc::gen::nonEmpty(rc::gen::container<std::vector<std::string>>(
      rc::gen::element<std::string>("__DEFAULT__", "slow", "fast", "off")));
  Plant plant;
  for (const std::string& mode : wanted) RC_ASSERT(plant.modes.change_mode("/pump", mode));
  plant.run(5s);
  // Requests that cross on their way may leave another mode, but never none.
  const std::string mode = plant.mode();
  RC_ASSERT(mode != ModeManager::kUnknown);
  RC_ASSERT(plant.change(wanted.back()));
  RC_ASSERT(plant.mode() == wanted.back());
}

// ---- as a component of a managing system

constexpr const char* kRules = R"(
COMPONENT modes      NODE /modes      LAUNCH "modes"
COMPONENT pump       NODE /pump
COMPONENT pump_node  NODE /pump_node
SIGNAL rate PARAMETER pump_node rate
RULE Slow
  POLICIES ERROR
  TRIGGER rate < 9
    STRATEGY fast 90 10
      ADAPTATION pump change_mode fast 5
    STRATEGY fast_anew 50 10
      ADAPTATION modes redeploy 5
      ADAPTATION pump change_mode fast 5
)";

// What the manager resolved within ten seconds, and by what.
std::vector<std::string> resolved_by(Plant& plant, const std::string& text = kRules) {
  const RuleSet rules = *check(Source("test.rules", text)).rules;
  SimulatedRobot robot(rules, plant.world);
  Manager manager(rules, std::make_unique<PaperPlanner>(PaperSwitches{}), {});
  Runtime runtime(manager, robot);
  std::vector<std::string> strategies;
  runtime.on_events = [&](std::span<const Event> events) {
    for (const Event& event : events) {
      const auto* resolved = std::get_if<FailureResolved>(&event.what);
      if (resolved != nullptr && resolved->strategy)
        strategies.push_back(rules[*resolved->strategy].name);
    }
  };
  const std::atomic<bool> never = false;
  runtime.run(never, later(plant.world.now(), 10s));
  return strategies;
}

TEST(SimulatedSystem, IsAComponentWhoseModeIsChangedAndReadBack) {
  Plant plant;
  EXPECT_THAT(resolved_by(plant), testing::ElementsAre("fast"));
  EXPECT_EQ(plant.mode(), "fast");
}

TEST(SimulatedSystem, IsNotThereWithoutItsModeManager) {
  Plant plant;
  plant.modes.kill();
  EXPECT_THAT(resolved_by(plant), testing::ElementsAre("fast_anew"));
  EXPECT_EQ(plant.mode(), "fast");
}

TEST(SimulatedSystem, DoesNotAnswerWhileItsModeManagerHangs) {
  Plant plant;
  plant.modes.hang();
  EXPECT_THAT(resolved_by(plant), testing::ElementsAre("fast_anew"));
  EXPECT_EQ(plant.mode(), "fast");
}

TEST(SimulatedSystem, RefusesAModeThatThereIsNot) {
  Plant plant;
  std::string rules = kRules;
  for (auto at = rules.find("change_mode fast"); at != std::string::npos;
       at = rules.find("change_mode fast"))
    rules.replace(at, 16, "change_mode turbo");
  EXPECT_THAT(resolved_by(plant, rules), testing::IsEmpty());
  EXPECT_EQ(plant.mode(), "off");
}

}  // namespace
}  // namespace culprit::simulation
