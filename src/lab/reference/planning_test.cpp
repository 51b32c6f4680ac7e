// The reference's choices: cost, D, C and S, and in which order.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reference/test_ticks.h"

namespace culprit::test {
namespace {

using study::ReferenceOptions;
using testing::ElementsAre;
using testing::IsEmpty;

// The camera is silent, and so is all behind it.
void break_camera(Ticks& ticks) {
  for (const char* topic : {"rgb_camera_freq", "sensors_fused_freq", "segmentation_freq"})
    ticks.signal(topic, 0.0);
}

std::vector<double> costs(ReferenceOptions options, const std::vector<std::string>& strategies) {
  const RuleSet rules = rules_of(sunset_reference_rules());
  const study::reference::Costs cost(rules, options);
  std::vector<double> all;
  for (const std::string& name : strategies) {
    for (std::size_t s = 0; s < rules.strategies.size(); ++s) {
      if (rules.strategies[s].name == name)
        all.push_back(cost(StrategyId(s), rules.strategies[s].success));
    }
  }
  return all;
}

const std::vector<std::string> kStrategies = {"autofocus_strategy",   "recalibration",
                                              "rgb_restart",          "rgb_redeploy",
                                              "enhancement_activate", "enhancement_deactivate"};

TEST(ReferenceCost, IsThatOfThePublicCode) {
  const std::vector<double> expected = {0, 0.10, 0.78, 1.18, 0.66, 0.68};
  EXPECT_THAT(costs({}, kStrategies), testing::Pointwise(testing::DoubleNear(1e-12), expected));
}

TEST(ReferencePlanning, RestartsFirstWithSAndRedeploysFirstWithout) {
  Ticks with;
  with.signal("segmentation_freq", 0.0);
  with.run();
  EXPECT_TRUE(with.has_said("0 segmentation_restart chosen")) << with.transcript();

  Ticks without(without_s(true, true));
  without.signal("segmentation_freq", 0.0);
  without.run();
  EXPECT_TRUE(without.has_said("0 segmentation_redeploy chosen")) << without.transcript();
}

TEST(ReferencePlanning, BlamesTheCameraAloneWithDAndC) {
  Ticks ticks;
  break_camera(ticks);
  ticks.run(20);
  EXPECT_THAT(ticks.asked, ElementsAre("0 camera: deactivate", "0 camera: activate"));
}

TEST(ReferencePlanning, AdaptsEverythingWithoutD) {
  for (const bool criticality : {false, true}) {
    Ticks ticks(without_s(false, criticality));
    break_camera(ticks);
    ticks.run();
    EXPECT_THAT(ticks.asked, ElementsAre("0 camera: stop process", "0 fusion: stop process",
                                         "0 segmentation: stop process"))
        << "C is " << criticality;
  }
}

// The fusion was detected last, so it is chosen before the camera is; the segmentation depends on
// both. Once they were seen busy, it does not wait for them.
TEST(ReferencePlanning, HoldsBackWithDOnlyWhatDependsOnSomethingChosenBefore) {
  Ticks ticks(without_s(true, false));
  break_camera(ticks);
  ticks.run(3);
  EXPECT_THAT(ticks.said,
              ElementsAre("0 SegmentationDead detected", "0 RGBDead detected",
                          "0 SensorFusionDead detected", "0 sensor_fusion_redeploy chosen",
                          "0 rgb_redeploy chosen", "1 segmentation_redeploy chosen"));
}

TEST(ReferencePlanning, OrdersEqualCostsAsAHashSetOfAddressesWould) {
  study::reference::SentRules apart(5, 0);
  for (const std::size_t rule : {2, 0, 4}) apart.insert(RuleId(rule));
  EXPECT_THAT(apart.in_order(), ElementsAre(RuleId(4), RuleId(0), RuleId(2)));
  apart.erase(RuleId(0));
  EXPECT_THAT(apart.in_order(), ElementsAre(RuleId(4), RuleId(2)));

  // With some seed two of three collide: they stay together.
  const auto order = [](std::uint64_t seed) {
    study::reference::SentRules set(3, seed);
    for (const std::size_t rule : {0, 1, 2}) set.insert(RuleId(rule));
    return std::vector<RuleId>(set.in_order().begin(), set.in_order().end());
  };
  bool is_ever_other = false;
  for (std::uint64_t seed = 1; seed < 100; ++seed) {
    EXPECT_EQ(order(seed), order(seed));
    is_ever_other |= order(seed) != order(0);
  }
  EXPECT_TRUE(is_ever_other);
}

TEST(ReferencePlanning, HoldsBackTheDependantsOfAnExhaustedRuleForEver) {
  Ticks ticks;
  break_camera(ticks);
  ticks.run(1000);
  EXPECT_TRUE(ticks.has_said("81 RGBDead exhausted")) << ticks.transcript();
  EXPECT_THAT(ticks.asked, ElementsAre("0 camera: deactivate", "0 camera: activate",
                                       "28 camera: stop process", "29 camera: start process"));
}

TEST(ReferencePlanning, NeverAdaptsADependentComponentForALowestLevelFailureWithDAndC) {
  const std::string rules = R"(
CYCLE 40ms
COMPONENT camera  NODE /managed_subsystem/camera
COMPONENT fusion  NODE /managed_subsystem/sensor_fusion
SIGNAL camera_autofocus_needed DIAGNOSTIC blackboard KEY k
RULE Shaky
  POLICIES NON_CRITICAL
  TRIGGER camera_autofocus_needed == true
    STRATEGY shift 100 10
      ADAPTATION fusion set_parameter image_shift 3 1
)";
  ReferenceOptions options;
  options.initial = {{"camera_autofocus_needed", false}};
  for (const bool criticality : {true, false}) {
    options.switches.criticality = criticality;
    Ticks ticks(options, rules);
    ticks.signal("camera_autofocus_needed", true);
    ticks.run();
    EXPECT_EQ(ticks.asked.empty(), criticality) << ticks.transcript();
  }
}

TEST(ReferencePlanning, KnowsTheDependenciesOfTheStartForGood) {
  Ticks ticks;
  ticks.signal("segmentation_entropy", 0.1);
  ticks.run(10);  // enhancement_activate is under way: the fusion listens to the enhancement
  ticks.publish("image_enhancement", "rgb_enhanced");
  ticks.subscribe("fusion", "rgb_enhanced");
  ticks.run(20);
  EXPECT_TRUE(ticks.has_said("17 enhancement_deactivate chosen"))
      << "the rule made both sick, and would block itself" << ticks.transcript();
}

TEST(ReferencePlanning, TakesTheSnapshotInTheTickThatItIsTold) {
  ReferenceOptions options;
  options.graph_frozen_at = Time{std::chrono::milliseconds(80)};
  Ticks ticks(options);
  ticks.run(2);
  ticks.subscribe("segmentation", "depth");
  ticks.run(1);
  ticks.subscribe("depth", "camera");  // too late
  ticks.signal("depth_camera_freq", 0.0);
  ticks.signal("rgb_camera_freq", 0.0);
  ticks.signal("segmentation_freq", 0.0);
  ticks.run(1);
  EXPECT_TRUE(ticks.has_said("3 depth_restart chosen")) << ticks.transcript();
  EXPECT_FALSE(ticks.has_said("3 segmentation_restart chosen")) << ticks.transcript();
}

TEST(ReferencePlanning, SaysWhyAFailureWaitsOnceUntilItChanges) {
  Ticks ticks;
  break_camera(ticks);
  ticks.run(20);
  std::vector<FailureHeldBack> held;
  for (const Event& event : ticks.events) {
    if (const auto* e = std::get_if<FailureHeldBack>(&event.what)) held.push_back(*e);
  }
  ASSERT_EQ(held.size(), 2u);
  for (const FailureHeldBack& e : held) {
    for (const Candidate& candidate : e.candidates)
      EXPECT_EQ(candidate.excluded, Condition::kDependency);
  }
}

TEST(ReferencePlanning, GivesThePlannedFailureAllItsCandidatesByCost) {
  Ticks ticks;
  ticks.signal("segmentation_entropy", 0.1);
  ticks.run();
  ASSERT_EQ(ticks.events.size(), 2u);
  const auto& chosen = std::get<StrategyChosen>(ticks.events[1].what);
  ASSERT_EQ(chosen.candidates.size(), 3u);
  EXPECT_FALSE(chosen.candidates[0].excluded);
  EXPECT_EQ(chosen.candidates[1].excluded, Condition::kOneEach);
  EXPECT_EQ(chosen.candidates[2].strategy, ticks.strategy("enhancement_deactivate"));
}

TEST(ReferencePlanning, DoesNothingWhileNothingFails) {
  Ticks ticks;
  ticks.run(100);
  EXPECT_THAT(ticks.events, IsEmpty());
}

}  // namespace
}  // namespace culprit::test
