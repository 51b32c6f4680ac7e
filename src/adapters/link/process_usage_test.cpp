#include "link/process_usage.h"

#include <unistd.h>

#include <gtest/gtest.h>

namespace culprit::link {
namespace {

using namespace std::chrono_literals;

TEST(ProcessUsage, IsReadOfAProcessThatRuns) {
  const auto own = usage_of(getpid());
  ASSERT_TRUE(own);
  EXPECT_GE(own->processor, Duration::zero());
  EXPECT_GT(own->resident_mib, 0.5);
  EXPECT_FALSE(usage_of(-1));
}

TEST(UsageMeter, MeasuresBetweenTwoLooksAtOneProcess) {
  UsageMeter meter;
  EXPECT_FALSE(meter.look(7, {10s, 1}, Time(100s)));
  EXPECT_EQ(meter.look(7, {10s + 500ms, 1}, Time(101s)), 0.5);
  EXPECT_EQ(meter.look(7, {13s + 500ms, 1}, Time(103s)), 1.5);
  EXPECT_FALSE(meter.look(8, {1s, 1}, Time(104s)));
  EXPECT_EQ(meter.look(8, {1s, 1}, Time(105s)), 0.0);
}

// A look that was a second late is followed by one in time: 10 ms of work in 1 ms are no ten cores.
TEST(UsageMeter, MeasuresNoShortTime) {
  UsageMeter meter;
  EXPECT_FALSE(meter.look(7, {10s, 1}, Time(100s)));
  EXPECT_FALSE(meter.look(7, {10s + 10ms, 1}, Time(100s + 1ms)));
  EXPECT_EQ(meter.look(7, {10s + 500ms, 1}, Time(101s)), 0.5) << "of the whole time";
}

}  // namespace
}  // namespace culprit::link
