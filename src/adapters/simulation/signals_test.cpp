// Checks the fields of topics and the diagnostics that a simulated robot reports.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "language/checker.h"
#include "simulation/simulated_robot.h"
#include "simulation/topic.h"

namespace culprit::simulation {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

struct Depth {
  double metres = 0;
};
std::optional<Value> field_of(const Depth& depth, std::string_view field) {
  if (field != "data") return std::nullopt;
  return depth.metres;
}

constexpr const char* kSignalRules = R"(
SIGNAL depth    TOPIC /depth FIELD data
SIGNAL nothing  TOPIC /depth FIELD nothing
SIGNAL own      DIAGNOSTIC pump KEY heat
SIGNAL any      DIAGNOSTIC * KEY heat
RULE Deep
  POLICIES ERROR
  TRIGGER depth > 5 || nothing > 5 || own > 5 || any > 5 || level(pump) > 1
    STRATEGY restart 50 10
      ADAPTATION /pump restart 5
)";

struct Sea {
  RuleSet rules = *check(Source("test.rules", kSignalRules)).rules;
  World world{1};
  Node sounder{world, "/sounder", {}};
  Topic<Depth> topic{world, "/depth", {{2ms, {}}, 0}};
  Publisher<Depth> depth{sounder, topic};
  SimulatedRobot robot{rules, world};

  Sea() {
    sounder.launch();
    world.run(Time{1s});
  }

  // "own 7" for each signal that was read since the last call.
  std::vector<std::string> told() {
    world.run(later(world.now(), 1s));
    std::vector<Observation> observations;
    robot.observe(world.now(), observations);
    std::vector<std::string> told;
    for (const Observation& observation : observations) {
      if (const auto* read = std::get_if<SignalRead>(&observation.what))
        told.push_back(rules[read->signal].name + " " + to_string(read->value));
      if (const auto* level = std::get_if<DiagnosticRead>(&observation.what))
        told.push_back("level " + std::to_string(level->level));
    }
    return told;
  }
};

TEST(SimulatedSignals, AreReadOffFieldsThatAMessageHas) {
  Sea sea;
  (void)sea.told();
  sea.depth.publish({3.5});
  EXPECT_THAT(sea.told(), ElementsAre("depth 3.5"));
}

TEST(SimulatedSignals, OfAnyStatusAreReadOffAllOfThem) {
  Sea sea;
  (void)sea.told();
  sea.world.diagnose("pump", "heat", 7.5);
  EXPECT_THAT(sea.told(), ElementsAre("own 7.5", "any 7.5"));
  sea.world.diagnose("", "heat", 8.5);
  EXPECT_THAT(sea.told(), ElementsAre("any 8.5"));
}

TEST(SimulatedSignals, HaveLevels) {
  Sea sea;
  (void)sea.told();
  sea.world.diagnose("pump", 2);
  sea.world.diagnose("other", 1);
  EXPECT_THAT(sea.told(), ElementsAre("level 2"));
}

}  // namespace
}  // namespace culprit::simulation
