#include "live/live_robot.h"

#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "base/test_folder.h"
#include "language/checker.h"
#include "ros2/live_test.h"

namespace culprit::live {
namespace {

using namespace std::chrono_literals;

// Until when a silence is judged the robot was heard, or nothing is judged: a moment before is not enough.
TEST(LiveRobot, JudgesNoSilenceThatItMayHaveMissed) {
  const ros2::TestDomain domain;
  const test::TestFolder folder;
  const Checked checked = check(Source("test.rules", R"(COMPONENT camera NODE /camera
RULE Silent
  POLICIES ERROR
  TRIGGER age(/camera/image) > 100ms
    STRATEGY s 50 10
      ADAPTATION camera restart 5
)"));
  ASSERT_TRUE(checked.rules);
  LiveRobot::Options options;
  options.link.participant = domain.options();
  options.supervisor.log_folder = folder.path();
  auto robot = LiveRobot::open(*checked.rules, std::move(options));
  ASSERT_TRUE(robot) << robot.error();
  std::vector<Observation> seen;
  // Before that it is not asked to come back.
  while ((*robot)->link().heard() > live_now()) (*robot)->observe(later(live_now(), 50ms), seen);
  int judged = 0;
  for (int i = 0; i < 40; ++i) {
    const Time until = later(live_now(), 7ms);
    while ((*robot)->observed_until() < until) (*robot)->observe(until, seen);
    if ((*robot)->deaf_since()) continue;
    EXPECT_GE((*robot)->link().heard(), until);
    ++judged;
  }
  EXPECT_GT(judged, 0);
}

}  // namespace
}  // namespace culprit::live
