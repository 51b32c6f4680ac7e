// When the reference calls a strategy a failure or a success, and what it forgets.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reference/test_ticks.h"

namespace culprit::test {
namespace {

using study::ReferenceOptions;
using testing::ElementsAre;

TEST(ReferenceAnalysis, GivesAParameterThreeTicksMoreThanItsWaitingTime) {
  Ticks ticks;
  ticks.signal("camera_autofocus_needed", true);
  ticks.run(6);
  EXPECT_THAT(ticks.said,
              ElementsAre("0 AutoFocusNeeded detected", "0 autofocus_strategy chosen",
                          "4 autofocus_strategy failed", "4 AutoFocusNeeded exhausted"));
}

TEST(ReferenceAnalysis, GivesAnActivationARestartAndARedeployTheirsToo) {
  Ticks f4;
  f4.signal("segmentation_entropy", 0.1);
  f4.run(40);
  EXPECT_TRUE(f4.has_said("4 enhancement_activate chosen")) << f4.transcript();
  EXPECT_TRUE(f4.has_said("17 enhancement_activate failed")) << f4.transcript();
  EXPECT_TRUE(f4.has_said("30 enhancement_deactivate failed")) << f4.transcript();

  Ticks f3;
  f3.signal("segmentation_freq", 0.0);
  f3.run(100);
  EXPECT_TRUE(f3.has_said("28 segmentation_restart failed")) << f3.transcript();
  EXPECT_TRUE(f3.has_said("28 segmentation_redeploy chosen")) << f3.transcript();
  EXPECT_TRUE(f3.has_said("81 segmentation_redeploy failed")) << f3.transcript();
}

TEST(ReferenceAnalysis, WaitsAsLongAsItsTableOrTheRuleFileSays) {
  ReferenceOptions options;
  options.impacts = study::ImpactTable::kStray;
  Ticks stray(options);
  stray.signal("segmentation_freq", 0.0);
  stray.run(20);
  EXPECT_TRUE(stray.has_said("13 segmentation_restart failed")) << stray.transcript();

  options.impacts = study::ImpactTable::kRuleFile;
  options.initial = {{"x", 0.0}};
  Ticks written(options, R"(
COMPONENT c NODE /managed_subsystem/c LAUNCH "c"
SIGNAL x DIAGNOSTIC d KEY k
RULE R
  POLICIES ERROR
  TRIGGER x > 0
    STRATEGY s 50 10
      ADAPTATION c restart 6
)");
  written.signal("x", 1.0);
  written.run(20);
  EXPECT_TRUE(written.has_said("9 s failed")) << written.transcript();
}

TEST(ReferenceAnalysis, TakesTheFirstFalseTriggerForASuccess) {
  Ticks ticks;
  ticks.signal("segmentation_freq", 0.0);
  ticks.run(1);
  ticks.signal("segmentation_freq", 10.0);
  ticks.run(1);
  EXPECT_TRUE(ticks.has_said("1 SegmentationDead resolved by segmentation_restart"))
      << "the answer has just come, and 25 ticks are waited for" << ticks.transcript();
}

TEST(ReferenceAnalysis, OverlooksATriggerThatIsFalseWhenTheCounterIsZero) {
  Ticks ticks;
  ticks.signal("camera_autofocus_needed", true);
  ticks.run(2);  // chosen in tick 0, the counter is -1 in tick 1
  ticks.signal("camera_autofocus_needed", false);
  ticks.run(1);
  EXPECT_FALSE(ticks.has_said("2 AutoFocusNeeded resolved by autofocus_strategy"));
  ticks.run(1);
  EXPECT_TRUE(ticks.has_said("3 AutoFocusNeeded resolved by autofocus_strategy"))
      << ticks.transcript();
}

TEST(ReferenceAnalysis, NeverTriesAnExhaustedRuleAgainWhileItsTriggerHolds) {
  Ticks ticks;
  ticks.signal("camera_autofocus_needed", true);
  ticks.run(1000);
  EXPECT_EQ(ticks.said.size(), 4u) << ticks.transcript();
  ticks.signal("camera_autofocus_needed", false);
  ticks.run(1);
  EXPECT_TRUE(ticks.has_said("1000 AutoFocusNeeded went away")) << ticks.transcript();
  ticks.signal("camera_autofocus_needed", true);
  ticks.run(1);
  EXPECT_TRUE(ticks.has_said("1001 autofocus_strategy chosen")) << ticks.transcript();
}

TEST(ReferenceAnalysis, CallsALateSuccessAFailureThatWentAway) {
  Ticks ticks;
  ticks.signal("camera_autofocus_needed", true);
  ticks.run(5);
  ticks.signal("camera_autofocus_needed", false);
  ticks.run(1);
  EXPECT_THAT(ticks.said, ElementsAre("0 AutoFocusNeeded detected", "0 autofocus_strategy chosen",
                                      "4 autofocus_strategy failed", "4 AutoFocusNeeded exhausted",
                                      "5 AutoFocusNeeded went away"));
}

// The fusion is sick (ERROR) until a failure of a lower level touches it too.
TEST(ReferenceAnalysis, LetsALaterRuleOverwriteTheHealthOfAComponent) {
  const auto restarts_segmentation = [](bool overwritten) {
    ReferenceOptions options;
    options.slips.overwritten_health = overwritten;
    Ticks ticks(options);
    ticks.signal("sensors_fused_freq", 0.0);
    ticks.run(2);
    ticks.signal("segmentation_entropy", 0.1);
    ticks.signal("segmentation_freq", 0.0);
    ticks.run(2);
    return ticks.has_said("2 segmentation_restart chosen");
  };
  EXPECT_TRUE(restarts_segmentation(true));
  EXPECT_FALSE(restarts_segmentation(false));
}

TEST(ReferenceAnalysis, LetsAnyResolvedRuleMakeItsComponentsHealthy) {
  const auto restarts_segmentation = [](bool overwritten) {
    ReferenceOptions options;
    options.slips.overwritten_health = overwritten;
    Ticks ticks(options);
    ticks.signal("segmentation_entropy", 0.1);
    ticks.run(1);
    ticks.signal("sensors_fused_freq", 0.0);  // now the fusion is sick
    ticks.run(2);
    ticks.signal("segmentation_entropy", 0.03);
    ticks.run(2);
    ticks.signal("segmentation_freq", 0.0);
    ticks.run(1);
    return ticks.has_said("5 segmentation_restart chosen");
  };
  EXPECT_TRUE(restarts_segmentation(true));
  EXPECT_FALSE(restarts_segmentation(false));
}

TEST(ReferenceAnalysis, LearnsOnlyWithoutTheSlip) {
  const auto learned = [](bool fixed) {
    ReferenceOptions options;
    options.slips.fixed_beliefs = fixed;
    Ticks ticks(options);
    ticks.signal("segmentation_freq", 0.0);
    ticks.run(30);  // the restart fails, the redeploy is under way
    ticks.signal("segmentation_freq", 10.0);
    ticks.run(1);
    return std::pair(ticks.manager().belief(ticks.strategy("segmentation_restart")),
                     ticks.manager().belief(ticks.strategy("segmentation_redeploy")));
  };
  EXPECT_EQ(learned(true), std::pair(Belief({4, 6}), Belief({6, 4})));
  EXPECT_EQ(learned(false), std::pair(Belief({4, 7}), Belief({7, 4})));
}

TEST(ReferenceAnalysis, HasNoDoubtAboutAHundredPercent) {
  Ticks ticks;
  const Belief belief = ticks.manager().belief(ticks.strategy("autofocus_strategy"));
  EXPECT_EQ(belief, Belief({10, 0}));
}

}  // namespace
}  // namespace culprit::test
