#include "link/clock_step.h"

#include <gtest/gtest.h>

namespace culprit::link {
namespace {

using namespace std::chrono_literals;

TEST(ClockStep, SeesAClockThatIsSetBackOnce) {
  ClockStep clock;
  EXPECT_FALSE(clock.look(1s, 1000000s));
  EXPECT_FALSE(clock.look(2s, 1000001s));
  EXPECT_EQ(clock.look(3s, 1000002s - 1h), -1h);
  EXPECT_FALSE(clock.look(4s, 1000003s - 1h));
}

TEST(ClockStep, SeesAClockThatIsSetAhead) {
  ClockStep clock;
  EXPECT_FALSE(clock.look(1s, 1000000s));
  EXPECT_EQ(clock.look(2s, 1000061s), 60s);
}

TEST(ClockStep, TakesNoAdjustmentForAStep) {
  ClockStep clock;
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(clock.look(i * 1s, i * 1500ms));
}

}  // namespace
}  // namespace culprit::link
