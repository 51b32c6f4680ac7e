// A robot of three components, each of which needs the one before.
#pragma once

#include <memory>

#include <gtest/gtest.h>

#include "manager/manager.h"
#include "manager/test_robot.h"

namespace culprit::test {

// camera -> fusion -> segmentation, each with a failure that restart or redeploy resolves.
inline constexpr const char* kPipeline = R"(
COMPONENT camera       NODE /camera       LAUNCH "camera"
COMPONENT fusion       NODE /fusion       LAUNCH "fusion"
COMPONENT segmentation NODE /segmentation LAUNCH "segmentation"
RULE CameraDead
  POLICIES ERROR
  TRIGGER age(/rgb) > 350ms
    STRATEGY restart 50 10
      ADAPTATION camera restart 3
    STRATEGY redeploy 90 10
      ADAPTATION camera redeploy 10
RULE FusionDead
  POLICIES ERROR
  TRIGGER age(/fused) > 350ms
    STRATEGY restart 50 10
      ADAPTATION fusion restart 3
    STRATEGY redeploy 90 10
      ADAPTATION fusion redeploy 10
RULE SegmentationDead
  POLICIES ERROR
  TRIGGER age(/segmentation) > 350ms
    STRATEGY restart 50 10
      ADAPTATION segmentation restart 3
    STRATEGY redeploy 90 10
      ADAPTATION segmentation redeploy 10
)";

inline TestRobot pipeline(std::unique_ptr<const Planner> planner,
                          Autonomy autonomy = Autonomy::kAct) {
  TestRobot robot(kPipeline, std::move(planner), autonomy);
  robot.add("camera", {}, "/rgb");
  robot.add("fusion", {"camera"}, "/fused");
  robot.add("segmentation", {"fusion"}, "/segmentation");
  robot.discover(2s);
  EXPECT_TRUE(robot.asked.empty());
  return robot;
}

}  // namespace culprit::test
