#include "terminal/progress.h"

#include <gtest/gtest.h>

namespace culprit {
namespace {

using namespace std::chrono_literals;

TEST(Progress, TellsHowFarItIsAndHowLongItWillTake) {
  EXPECT_EQ(progress_line(0, 8, 0, 0s), "[....................]   0 %  0/8");
  EXPECT_EQ(progress_line(2, 8, 0, 10s), "[#####...............]  25 %  2/8, 30 s left");
  EXPECT_EQ(progress_line(8, 8, 0, 10s), "[####################] 100 %  8/8, 0 s left");
}

TEST(Progress, CountsOnlyWhatWasDoneNow) {
  EXPECT_EQ(progress_line(6, 8, 4, 10s), "[###############.....]  75 %  6/8, 10 s left");
  EXPECT_EQ(progress_line(4, 8, 4, 10s), "[##########..........]  50 %  4/8");
}

TEST(Progress, SpeaksOfMinutesAndHours) {
  EXPECT_EQ(progress_line(1, 2, 0, 90s), "[##########..........]  50 %  1/2, 1 min 30 s left");
  EXPECT_EQ(progress_line(1, 2, 0, 7300s), "[##########..........]  50 %  1/2, 2 h 1 min left");
}

}  // namespace
}  // namespace culprit
