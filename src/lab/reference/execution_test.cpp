// Execution of strategies by the reference: rounds with a barrier, and answers that are awaited or
// ignored.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reference/test_ticks.h"

namespace culprit::test {
namespace {

using study::ReferenceOptions;
using testing::ElementsAre;

TEST(ReferenceExecution, StartsTheNewProcessOneTickAfterTheOldOneWasStopped) {
  Ticks ticks(without_s(true, true));
  ticks.signal("segmentation_freq", 0.0);
  ticks.run(3);
  EXPECT_THAT(ticks.asked,
              ElementsAre("0 segmentation: stop process", "1 segmentation: start process"));
}

TEST(ReferenceExecution, DoesNotStartAComponentThatRefusedToStop) {
  Ticks ticks(without_s(true, true));
  ticks.refusing = {"segmentation"};
  ticks.signal("segmentation_freq", 0.0);
  ticks.run(20);
  EXPECT_THAT(ticks.asked, ElementsAre("0 segmentation: stop process"));
}

TEST(ReferenceExecution, ActivatesInARestartEvenIfTheDeactivationWasRefused) {
  Ticks ticks;
  ticks.refusing = {"segmentation"};
  ticks.signal("segmentation_freq", 0.0);
  ticks.run(2);
  EXPECT_THAT(ticks.asked, ElementsAre("0 segmentation: deactivate", "0 segmentation: activate"));
}

TEST(ReferenceExecution, TellsNobodyThatARequestWasRefused) {
  Ticks ticks;
  ticks.refusing = {"segmentation"};
  ticks.signal("segmentation_freq", 0.0);
  ticks.run(28);
  EXPECT_FALSE(ticks.has_said("28 segmentation_restart failed"));
  ticks.run(1);
  EXPECT_TRUE(ticks.has_said("28 segmentation_restart failed")) << ticks.transcript();
}

TEST(ReferenceExecution, KeepsANewRequestBackUntilTheSlowestComponentIsThrough) {
  Ticks ticks;
  ticks.mute = {"segmentation"};
  ticks.signal("segmentation_freq", 0.0);
  ticks.run(1);
  ticks.signal("depth_camera_freq", 0.0);
  ticks.run(200);
  EXPECT_TRUE(ticks.has_said("1 depth_restart chosen")) << ticks.transcript();
  EXPECT_TRUE(ticks.has_said("29 depth_restart failed")) << "and was never asked for";
  EXPECT_FALSE(ticks.has_said("29 depth_redeploy chosen")) << "it is reserved for the restart";
  EXPECT_THAT(ticks.asked, ElementsAre("0 segmentation: deactivate"));
}

TEST(ReferenceExecution, AsksInTheTickAfterTheRoundIsOver) {
  Ticks ticks;
  ticks.signal("segmentation_freq", 0.0);
  ticks.run(1);  // its answer is seen in tick 1
  ticks.signal("depth_camera_freq", 0.0);
  ticks.run(3);
  EXPECT_TRUE(ticks.has_said("1 depth_restart chosen")) << ticks.transcript();
  EXPECT_TRUE(ticks.has_asked("2 depth: deactivate")) << ticks.transcript();
}

TEST(ReferenceExecution, ChangesLifecyclesAndCommunicationOfAStrategyAtOnce) {
  Ticks ticks;
  ticks.signal("segmentation_entropy", 0.1);
  ticks.run(6);
  EXPECT_THAT(ticks.asked,
              ElementsAre("0 fusion: set do_recalibration to true", "4 image_enhancement: activate",
                          "4 fusion: set topic_camera_input to \"rgb_enhanced\""));
}

TEST(ReferenceExecution, GoesOnWithAComponentInTheNextRoundAfterARefusal) {
  ReferenceOptions options;
  options.initial = {{"x", 0.0}};
  Ticks ticks(options, R"(
COMPONENT c NODE /managed_subsystem/c LAUNCH "c"
SIGNAL x DIAGNOSTIC d KEY k
RULE R
  POLICIES ERROR
  TRIGGER x > 0
    STRATEGY s 50 10
      ADAPTATION c activate 1
      ADAPTATION c set_parameter p 0.5 1
)");
  ticks.refusing = {"c"};
  ticks.signal("x", 1.0);
  ticks.run(3);
  EXPECT_THAT(ticks.asked, ElementsAre("0 c: activate", "2 c: set p to 0.5"));
}

TEST(ReferenceExecution, SendsAllEarlierParametersAgain) {
  Ticks ticks;
  for (int i = 0; i < 3; ++i) {
    ticks.signal("camera_autofocus_needed", true);
    ticks.run(2);
    ticks.signal("camera_autofocus_needed", false);
    ticks.run(2);
  }
  EXPECT_EQ(ticks.asked.size(), 1u + 2 + 3) << ticks.transcript();
}

TEST(ReferenceExecution, SendsNumbersAsDoubles) {
  ReferenceOptions options;
  options.initial = {{"camera_autofocus_needed", false}};
  Ticks ticks(options, R"(
CYCLE 40ms
COMPONENT camera NODE /managed_subsystem/camera
SIGNAL camera_autofocus_needed DIAGNOSTIC blackboard KEY k
RULE R
  POLICIES ERROR
  TRIGGER camera_autofocus_needed == true
    STRATEGY s 100 10
      ADAPTATION camera set_parameter image_shift 3 1
)");
  ticks.signal("camera_autofocus_needed", true);
  ticks.run();
  EXPECT_THAT(ticks.asked, ElementsAre("0 camera: set image_shift to 3.0"));
}

}  // namespace
}  // namespace culprit::test
