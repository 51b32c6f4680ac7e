#include "simulation/mode_manager.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "knowledge/describe.h"
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

modes::Model pump_modes() {
  const auto sets = [](std::int64_t rate) { return std::map<std::string, Value>{{"rate", rate}}; };
  const auto wants = [](const modes::Target& target) {
    return std::map<std::string, modes::Target>{{"/pump_node", target}};
  };
  modes::Entity node;
  node.name = "/pump_node";
  node.modes = {{"__DEFAULT__", {}, sets(1)}, {"slow", {}, sets(1)}, {"fast", {}, sets(9)}};
  modes::Entity system;
  system.name = "/pump";
  system.is_system = true;
  system.parts = {node.name};
  system.modes = {{"__DEFAULT__", wants({true, "__DEFAULT__"}), {}},
                  {"slow", wants({true, "slow"}), {}},
                  {"fast", wants({true, "fast"}), {}},
                  {"off", wants({false, ""}), {}}};
  return {{node, system}};
}

struct Plant {
  World world{1};
  Pump pump{world};
  ModeManager modes;

  explicit Plant(NodeTraits manager = {}) : modes(world, "/modes", pump_modes(), manager) {
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
  EXPECT_EQ(plant.mode(), kUnknownMode);
}

TEST(ModeManager, SeesAPartThatBeganAnew) {
  Plant plant;
  plant.change("fast");
  plant.pump.kill();
  plant.run(1s);
  EXPECT_EQ(plant.mode(), "fast");  // no request changed it
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
  RC_ASSERT(mode != kUnknownMode);
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

// The failures that the manager resolved within ten seconds, and by which strategy.
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

// ---- what can go wrong with a mode

// Does what a test wants, at times, beside the manager.
struct Later {
  Duration at;
  std::function<void(Plant&)> what;
};

// The manager's messages while it watches `plant` for `time`.
std::vector<std::string> said(Plant& plant, const std::string& text, Duration time,
                              const std::vector<Later>& meanwhile = {}) {
  const RuleSet rules = *check(Source("test.rules", text)).rules;
  SimulatedRobot robot(rules, plant.world);
  Manager manager(rules, std::make_unique<PaperPlanner>(PaperSwitches{}), {});
  Runtime runtime(manager, robot);
  std::vector<std::string> lines;
  runtime.on_events = [&](std::span<const Event> events) {
    for (const Event& event : events) lines.push_back(describe(event, rules));
  };
  for (const Later& each : meanwhile)
    plant.world.after(each.at, [&plant, what = each.what] { what(plant); });
  const std::atomic<bool> never = false;
  runtime.run(never, later(plant.world.now(), time));
  return lines;
}

TEST(SimulatedSystem, IsNeverBroughtBackToAnUnknownMode) {
  Plant plant;
  plant.change("fast");
  plant.pump.set_parameter("rate", std::int64_t{5});
  plant.run(1s);
  ASSERT_EQ(plant.mode(), kUnknownMode);
  const auto lines = said(plant, R"(
COMPONENT pump NODE /pump
COMPONENT pump_node NODE /pump_node
SIGNAL rate PARAMETER pump_node rate
RULE NotSix
  POLICIES ERROR ATTEMPTS 1
  TRIGGER rate != 6
    STRATEGY slow 90 10
      ADAPTATION pump change_mode slow 5
)",
                          10s);
  EXPECT_THAT(lines, testing::Contains(testing::StartsWith("slow did not resolve NotSix")));
  EXPECT_THAT(lines, testing::Not(testing::Contains(testing::HasSubstr("undone"))));
  EXPECT_EQ(plant.mode(), "slow");
}

// Killed at any moment of the change: the mode is reached all the same, by a manager that was
// started again.
TEST(SimulatedSystem, ReachesItsModeThoughItsModeManagerDiesInBetween) {
  const std::string rules = std::string(kRules) + R"(
RULE ModesDead
  POLICIES ERROR
  TRIGGER !alive(modes)
    STRATEGY redeploy_modes 90 10
      ADAPTATION modes redeploy 5
)";
  for (Duration at = 0ms; at < 60ms; at += 3ms) {
    NodeTraits slow;
    slow.service = {5ms, 5ms};
    Plant plant(slow);
    said(plant, rules, 60s, {{at, [](Plant& p) { p.modes.kill(); }}});
    EXPECT_EQ(plant.mode(), "fast") << "killed at " << to_string(at);
    EXPECT_EQ(plant.modes.process(), ProcessState::kRunning);
  }
}

// Something that sets a mode back, so many times, a second after it was changed.
std::vector<Later> rival(const std::string& mode, Duration until) {
  std::vector<Later> all;
  for (Duration at = 1s; at < until; at += 1s) {
    all.push_back({at, [mode](Plant& plant) {
                     if (plant.mode() == "fast") plant.modes.change_mode("/pump", mode);
                   }});
  }
  return all;
}

TEST(SimulatedSystem, IsLeftAloneIfSomethingElseSetsItsModeBackTwice) {
  Plant plant;
  plant.change("slow");
  const auto lines = said(plant, kRules, 60s, rival("slow", 60s));
  EXPECT_EQ(std::count(lines.begin(), lines.end(),
                       "another program sets the mode of pump back; culprit leaves it alone"),
            1);
  EXPECT_EQ(plant.mode(), "slow");
  EXPECT_THAT(lines, testing::Contains(testing::HasSubstr("pump is set back by something else")));
}

TEST(SimulatedSystem, IsNoRivalsWhenItsPartBeganAnew) {
  Plant plant;
  plant.change("off");
  const std::string rules = std::string(kRules) + "DEPENDENCY pump ON pump_node\n";
  std::vector<Later> restarts;
  for (Duration at = 2s; at < 20s; at += 3s) {
    restarts.push_back({at, [](Plant& p) {
                          p.pump.kill();
                          p.pump.launch();
                        }});
  }
  const auto lines = said(plant, rules, 30s, restarts);
  EXPECT_THAT(lines, testing::Not(testing::Contains(testing::HasSubstr("leaves it alone"))));
  EXPECT_EQ(plant.mode(), "fast");
}

// A routine that resets its parameter when it is done is no rival.
class Washer : public Node {
 public:
  explicit Washer(World& world) : Node(world, "/washer", {}) {
    declare("wash", false);
    declare("dirt", std::int64_t{0});
  }

 private:
  bool on_set(const std::string& name, const Value& value) override {
    if (name != "wash" || value != Value(true)) return true;
    world().after(20ms, [this] {
      assign("wash", false);
      assign("dirt", std::int64_t{0});
    });
    return true;
  }
};

TEST(SimulatedParameter, ThatResetsItselfIsSetAsOftenAsItHelps) {
  Plant plant;
  Washer washer(plant.world);
  washer.launch();
  std::vector<Later> dirt;
  for (Duration at = 1s; at < 20s; at += 4s)
    dirt.push_back({at, [&](Plant&) { washer.set_parameter("dirt", std::int64_t{7}); }});
  const auto lines = said(plant, R"(
COMPONENT washer NODE /washer
SIGNAL dirt PARAMETER washer dirt
RULE Dirty
  POLICIES ERROR
  TRIGGER dirt > 5
    STRATEGY wash 90 10
      ADAPTATION washer set_parameter wash true 5
)",
                          25s, dirt);
  EXPECT_THAT(lines, testing::Not(testing::Contains(testing::HasSubstr("leaves it alone"))));
  EXPECT_EQ(*washer.parameter("dirt"), Value(std::int64_t{0}));
  EXPECT_EQ(std::count(lines.begin(), lines.end(), "Dirty detected (ERROR)"), 5);
}

TEST(SimulatedSystem, ThatAcceptsAModeAndDoesNothingIsSaidSo) {
  Plant plant;
  plant.pump.stop();  // its mode manager's request never reaches it
  const auto lines = said(plant, R"(
COMPONENT modes NODE /modes
COMPONENT pump NODE /pump
SIGNAL reading TOPIC /reading FIELD data
RULE Off
  POLICIES ERROR ATTEMPTS 1
  TRIGGER alive(modes)
    STRATEGY fast 90 10
      ADAPTATION pump change_mode fast 5
)",
                          30s);
  EXPECT_THAT(lines, testing::Contains(testing::HasSubstr(
                         "it accepted and did nothing: not mode fast after 10.0 s")));
}

}  // namespace
}  // namespace culprit::simulation
