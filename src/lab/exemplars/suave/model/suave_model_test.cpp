#include "exemplars/suave/model/suave_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "simulation/fault.h"

namespace culprit::suave::model {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

// A mission with actions at given times, in the mission's time.
struct Sea {
  explicit Sea(const char* plan = "standard", const char* generation = "era",
               Leader leader = Leader::kMission, std::uint64_t seed = 1)
      : model({**find_generation(generation), **find_mission_plan(plan), leader, {}}, seed) {}

  void change_mode(Duration at, const char* system, const char* mode) {
    model.world().at(later(model.guided(), at), [this, system, mode] {
      EXPECT_TRUE(model.world().modes_of(system)->change_mode(system, mode));
    });
  }
  void run(Duration until) { model.world().run(later(model.guided(), until)); }
  simulation::Node& node(const char* name) { return *model.world().node(name); }
  Metrics& metrics() { return model.metrics(); }

  SuaveModel model;
};

// The values of a key on /diagnostics, with the mission's time.
struct Listener : simulation::Watcher {
  Listener(Sea& of, std::string of_key) : sea(of), key(std::move(of_key)) {
    sea.model.world().watch(*this);
  }
  ~Listener() override { sea.model.world().unwatch(*this); }
  void on_diagnostic(std::string_view, std::string_view said, const Value& value) override {
    if (said != key) return;
    values.push_back(value);
    at_s.push_back(seconds(sea.model.world().now() - sea.model.guided()));
  }
  Sea& sea;
  std::string key;
  std::vector<Value> values;
  std::vector<double> at_s;
};

TEST(Mission, SearchesLowAndThenInspectsWithoutAManager) {
  Sea sea;
  sea.run(1s);
  EXPECT_TRUE(sea.node(nodes::kSearch).is_active());
  EXPECT_EQ(*sea.node(nodes::kSearch).parameter(kAltitude), Value(1.0));
  EXPECT_FALSE(sea.node(nodes::kFollow).is_active());
  while (!sea.metrics().found() && !sea.model.mission().ended()) sea.model.world().step(kNever);
  ASSERT_TRUE(sea.metrics().found());
  sea.model.world().run(later(*sea.metrics().found(), 2s));
  EXPECT_FALSE(sea.node(nodes::kSearch).is_active());
  EXPECT_TRUE(sea.node(nodes::kFollow).is_active());
  sea.model.world().run(later(*sea.metrics().found(), 60s));
  EXPECT_GT(sea.metrics().distance(), 5);
}

TEST(Mission, EndsWhenItsTimeIsOver) {
  Sea sea;
  sea.run(299s);
  EXPECT_FALSE(sea.model.mission().ended());
  sea.run(301s);
  ASSERT_TRUE(sea.model.mission().ended());
  EXPECT_GE(*sea.model.mission().ended() - sea.model.guided(), 300s);
  EXPECT_LE(*sea.model.mission().ended(), sea.model.latest_end());
}

TEST(Mission, LeavesModesToTheLeader) {
  Sea bridged("standard", "era", Leader::kBridge);
  Sea led("standard", "era", Leader::kManager);
  bridged.run(60s);
  led.run(60s);
  EXPECT_FALSE(bridged.node(nodes::kSearch).is_active());
  EXPECT_FALSE(led.node(nodes::kSearch).is_active());
}

TEST(Thrusters, FailAsPlannedAndAreRecoveredTenSecondsAfterTheActivation) {
  Sea sea;
  Listener first(sea, "c_thruster_1");
  Listener last(sea, "c_thruster_6");
  sea.change_mode(40s, systems::kMotion, modes::kRecover);
  sea.run(60s);
  EXPECT_THAT(first.values, ElementsAre(Value(std::string("FALSE")), Value(std::string("ERROR")),
                                        Value(std::string("RECOVERED"))));
  EXPECT_GE(first.at_s[0], 35);
  EXPECT_LT(first.at_s[0], 36);
  EXPECT_NEAR(first.at_s[2], 50, 0.1);
  EXPECT_NEAR(last.at_s[0], 51.25, 0.1);
  ASSERT_EQ(sea.metrics().thruster().answered_s.size(), 1u);
  EXPECT_NEAR(sea.metrics().thruster().answered_s[0], 40 - first.at_s[0], 0.1);
}

TEST(Thrusters, AreRecoveredThoughSwitchedOffInTheOldGenerationOnly) {
  for (const char* generation : {"era", "new"}) {
    Sea sea("standard", generation);
    Listener last(sea, "c_thruster_6");
    sea.change_mode(40s, systems::kMotion, modes::kRecover);
    sea.change_mode(45s, systems::kMotion, modes::kAllThrusters);
    sea.run(60s);
    EXPECT_EQ(last.values.size(), generation == std::string("era") ? 1u : 0u) << generation;
  }
}

// 150 subtractions of 1/200 end just below a quarter, in double precision only.
TEST(Battery, IsAQuarterInSinglePrecisionASecondLongerThanInDouble) {
  Sea sea;
  Listener battery(sea, "battery_level");
  sea.run(160s);
  ASSERT_GT(battery.values.size(), 152u);
  const double level = std::get<double>(battery.values[149]);
  EXPECT_LT(level, 0.25);
  EXPECT_EQ(static_cast<float>(level), 0.25F);
  EXPECT_LT(static_cast<float>(std::get<double>(battery.values[150])), 0.25F);
  EXPECT_NEAR(battery.at_s[149], 149.5, 0.5);
}

TEST(Battery, IsChargedAtTheStation) {
  Sea sea("extended");
  sea.change_mode(150s, systems::kSearch, modes::kOff);
  sea.change_mode(150s, systems::kFollow, modes::kOff);
  sea.change_mode(152s, systems::kRecharge, modes::kRecharge);
  sea.run(153s);
  ASSERT_EQ(sea.metrics().battery().answered_s.size(), 1u);
  EXPECT_LT(sea.model.battery().level(), 0.25);
  sea.run(260s);
  EXPECT_GT(sea.model.battery().level(), 0.5);
}

TEST(Battery, EndsAllMotionWhenItIsEmptyInTheStressMission) {
  for (const char* plan : {"stress", "extended"}) {
    Sea sea(plan, "era", Leader::kManager);
    sea.change_mode(1s, systems::kMotion, modes::kRecover);
    sea.run(210s);
    EXPECT_TRUE(sea.model.battery().ran_empty());
    sea.node(nodes::kRecharge).change(Transition::kActivate);
    sea.run(299s);
    EXPECT_EQ(sea.model.battery().level() > 0, plan == std::string("extended")) << plan;
  }
}

TEST(Metrics, CountAMismatchFromItsFirstReadingToTheExpectedAltitude) {
  Sea sea;
  sea.change_mode(2s, systems::kSearch, "fd_spiral_high");
  sea.change_mode(15s, systems::kSearch, "fd_spiral_low");  // not what is expected
  sea.change_mode(16s, systems::kSearch, "fd_spiral_medium");
  sea.run(20s);
  const auto& answered = sea.metrics().visibility().answered_s;
  ASSERT_EQ(answered.size(), 2u);
  EXPECT_LT(answered[0], 2.1);         // from the first reading, within a second
  EXPECT_NEAR(answered[1], 3.5, 0.6);  // from 12 to 13 s on
}

TEST(Metrics, SayWhatNobodyReactedTo) {
  Sea sea;
  sea.run(299s);
  sea.metrics().finish();
  EXPECT_THAT(sea.metrics().thruster().answered_s, IsEmpty());
  EXPECT_EQ(sea.metrics().thruster().unanswered_s.size(), 1u);
  EXPECT_EQ(sea.metrics().visibility().unanswered_s.size(), 1u);
}

TEST(Metrics, KeepTheDistanceBeforeAnInterruption) {
  Sea sea("standard", "new", Leader::kMission, 3);
  while (!sea.metrics().found()) ASSERT_TRUE(sea.model.world().step(sea.model.latest_end()));
  const Duration found = *sea.metrics().found() - sea.model.guided();
  sea.run(found + 60s);
  const double before = sea.metrics().distance();
  EXPECT_GT(before, 5);
  sea.change_mode(found + 61s, systems::kFollow, modes::kOff);
  sea.change_mode(found + 62s, systems::kFollow, modes::kFollow);
  sea.run(found + 90s);
  EXPECT_LT(sea.metrics().distance(), before);
  EXPECT_GT(sea.metrics().whole_distance(), before);
}

TEST(Generations, AreFoundByName) {
  EXPECT_EQ((*find_generation("new"))->detection_poll, 100ms);
  EXPECT_NE(find_generation("old").error().find("era, new"), std::string::npos);
  EXPECT_NE(find_mission_plan("").error().find("standard, extended, stress"), std::string::npos);
}

TEST(MissionPlans, BreakNodesThatThereAre) {
  for (const MissionPlan& plan : mission_plans()) {
    Sea sea(std::string(plan.name).c_str());
    for (const simulation::Fault& fault : plan.faults)
      EXPECT_TRUE(simulation::inject(sea.model.world(), fault)) << fault.node;
  }
}

}  // namespace
}  // namespace culprit::suave::model
