#include "owners/start_needs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::owners {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(StartNeeds, AParameterFileIsNeeded) {
  const auto needs = start_needs(
      {"/ws/lib/cam/driver", "--ros-args", "--params-file", "/tmp/launch_params_x"}, "");
  ASSERT_EQ(needs.size(), 1u);
  EXPECT_THAT(needs[0].places, ElementsAre("/tmp/launch_params_x"));
  EXPECT_EQ(needs[0].missing, "there is no parameter file '/tmp/launch_params_x'");
}

TEST(StartNeeds, Ros2RunNeedsTheProgramOfThePackage) {
  const auto needs =
      start_needs({"/usr/bin/ros2", "run", "cam", "driver", "--ros-args"}, "/ws:/opt");
  ASSERT_EQ(needs.size(), 1u);
  EXPECT_THAT(needs[0].places, ElementsAre("/ws/lib/cam/driver", "/opt/lib/cam/driver"));
  EXPECT_EQ(needs[0].missing, "package cam has no program 'driver' in AMENT_PREFIX_PATH");
}

TEST(StartNeeds, WithoutTheWorkspacesNothingIsSaidOfRos2Run) {
  EXPECT_THAT(start_needs({"ros2", "run", "cam", "driver"}, ""), IsEmpty());
}

TEST(StartNeeds, PythonNeedsItsScript) {
  const auto needs = start_needs({"/usr/bin/python3", "/ws/lib/cam/driver", "--ros-args"}, "");
  ASSERT_EQ(needs.size(), 1u);
  EXPECT_THAT(needs[0].places, ElementsAre("/ws/lib/cam/driver"));
}

TEST(StartNeeds, AModuleOrAnOptionIsNoScript) {
  EXPECT_THAT(start_needs({"python3", "-m", "cam/driver"}, ""), IsEmpty());
  EXPECT_THAT(start_needs({"python3", "driver"}, ""), IsEmpty());
}

}  // namespace
}  // namespace culprit::owners
