#include "modes/inference.h"

#include <gtest/gtest.h>

#include "modes/read_model.h"

namespace culprit::modes {
namespace {

constexpr const char* kPlant = R"(
plant: {ros__parameters: {type: system, parts: [pump, lamp], modes: {
  __DEFAULT__: {pump: active.SLOW, lamp: inactive},
  fast:        {pump: active.FAST, lamp: active},
  off:         {pump: inactive}}}}
pump: {ros__parameters: {type: node, modes: {
  __DEFAULT__: {ros__parameters: {rate: 1}},
  SLOW:        {ros__parameters: {rate: 1}},
  FAST:        {ros__parameters: {rate: 9}}}}}
lamp: {ros__parameters: {type: node, modes: {__DEFAULT__: {ros__parameters: {marker: x}}}}}
)";

struct Plant {
  Model model = *read_model("plant.yaml", kPlant);
  Inference inference{model};

  void pump(LifecycleState state, std::int64_t rate) {
    inference.heard_state("/pump", state);
    inference.heard_parameter("/pump", "rate", rate);
    inference.infer();
  }
  void lamp(LifecycleState state) {
    inference.heard_state("/lamp", state);
    inference.infer();
  }
  void aim(const std::string& entity, const Target& target) {
    inference.set_target(entity, target);
    inference.infer();
  }
  const Actual& actual(const std::string& entity) const { return inference.actual(entity); }
};

TEST(Inference, KnowsNothingOfWhatItNeverHeardOf) {
  const Plant plant;
  EXPECT_EQ(plant.actual("/pump"), (Actual{LifecycleState::kUnknown, ""}));
  EXPECT_EQ(plant.actual("/plant"), (Actual{LifecycleState::kUnknown, ""}));
}

TEST(Inference, PrefersTheModeThatWasAskedFor) {
  Plant plant;
  plant.pump(LifecycleState::kActive, 1);
  EXPECT_EQ(plant.actual("/pump").mode, "__DEFAULT__");
  plant.aim("/pump", {true, "SLOW"});
  EXPECT_EQ(plant.actual("/pump").mode, "SLOW");
  plant.pump(LifecycleState::kActive, 9);
  EXPECT_EQ(plant.actual("/pump").mode, "FAST");
  plant.pump(LifecycleState::kActive, 5);
  EXPECT_EQ(plant.actual("/pump").mode, "");
}

TEST(Inference, TakesANodeWithOneModeToBeInIt) {
  Plant plant;
  plant.lamp(LifecycleState::kActive);
  EXPECT_EQ(plant.actual("/lamp"), (Actual{LifecycleState::kActive, "__DEFAULT__"}));
}

TEST(Inference, InfersASystemThatNobodyAskedFor) {
  Plant plant;
  plant.pump(LifecycleState::kInactive, 1);
  plant.lamp(LifecycleState::kUnconfigured);
  EXPECT_EQ(plant.actual("/plant"), (Actual{LifecycleState::kInactive, "off"}));
  plant.pump(LifecycleState::kActive, 9);
  plant.lamp(LifecycleState::kActive);
  EXPECT_EQ(plant.actual("/plant"), (Actual{LifecycleState::kActive, "fast"}));
}

TEST(Inference, IsOnItsWayUntilEveryPartIsThere) {
  Plant plant;
  plant.pump(LifecycleState::kInactive, 1);
  plant.lamp(LifecycleState::kInactive);
  plant.aim("/plant", {true, "fast"});
  EXPECT_EQ(plant.actual("/plant"), (Actual{LifecycleState::kActivating, "off"}));
  plant.pump(LifecycleState::kActive, 9);
  EXPECT_EQ(plant.actual("/plant"), (Actual{LifecycleState::kActivating, ""}));
  plant.lamp(LifecycleState::kActive);
  EXPECT_TRUE(plant.inference.is_at("/plant", {true, "fast"}));
  plant.aim("/plant", {false, ""});
  EXPECT_EQ(plant.actual("/plant").state, LifecycleState::kDeactivating);
}

TEST(Inference, ShowsThatAPartIsInErrorProcessing) {
  Plant plant;
  plant.pump(LifecycleState::kActive, 9);
  plant.lamp(LifecycleState::kErrorProcessing);
  EXPECT_EQ(plant.actual("/plant").state, LifecycleState::kErrorProcessing);
}

TEST(Inference, ForgetsANodeThatIsGone) {
  Plant plant;
  plant.pump(LifecycleState::kActive, 9);
  plant.inference.lost("/pump");
  plant.inference.infer();
  EXPECT_EQ(plant.actual("/pump").state, LifecycleState::kUnknown);
}

}  // namespace
}  // namespace culprit::modes
