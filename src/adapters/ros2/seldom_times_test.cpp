#include "ros2/seldom_times.h"

#include <gtest/gtest.h>

namespace culprit::ros2 {
namespace {

using namespace std::chrono_literals;

// Asks once a second.
int times_in(SeldomTimes& times, Time begin, Duration length) {
  int count = 0;
  for (Time now = begin; now < begin + length; now += 1s) {
    if (!times.may_come(now)) continue;
    times.came(now);
    ++count;
  }
  return count;
}

TEST(SeldomTimes, BecomeSeldomWhileTheyGoOn) {
  SeldomTimes times;
  EXPECT_EQ(times_in(times, Time(1h), 11s), 2) << "soon again at first";
  EXPECT_LE(times_in(times, Time(2h), 1h), 5 + 12);
  EXPECT_LE(times_in(times, Time(3h), 1h), 12);
}

TEST(SeldomTimes, AreForgottenAfterAWhile) {
  SeldomTimes times;
  times_in(times, Time(1h), 1h);
  EXPECT_EQ(times_in(times, Time(3h), 11s), 2);
}

}  // namespace
}  // namespace culprit::ros2
