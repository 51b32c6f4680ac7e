// When the reference calls a strategy a failure or a success, and what it forgets.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reference/test_ticks.h"

namespace culprit::test {
namespace {

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
  Ticks ticks;
  ticks.signal("sensors_fused_freq", 0.0);
  ticks.run(2);
  ticks.signal("segmentation_entropy", 0.1);
  ticks.signal("segmentation_freq", 0.0);
  ticks.run(2);
  EXPECT_TRUE(ticks.has_said("2 segmentation_restart chosen")) << ticks.transcript();
}

TEST(ReferenceAnalysis, LetsAnyResolvedRuleMakeItsComponentsHealthy) {
  Ticks ticks;
  ticks.signal("segmentation_entropy", 0.1);
  ticks.run(1);
  ticks.signal("sensors_fused_freq", 0.0);  // now the fusion is sick
  ticks.run(2);
  ticks.signal("segmentation_entropy", 0.03);
  ticks.run(2);
  ticks.signal("segmentation_freq", 0.0);
  ticks.run(1);
  EXPECT_TRUE(ticks.has_said("5 segmentation_restart chosen")) << ticks.transcript();
}

}  // namespace
}  // namespace culprit::test
