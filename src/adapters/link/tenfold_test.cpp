#include "link/tenfold.h"

#include <gtest/gtest.h>

namespace culprit::link {
namespace {

TEST(Tenfold, ReportsTheFirstOnesAndThenEachTenfold) {
  Tenfold report(100);
  EXPECT_FALSE(report.is_due(0));
  EXPECT_FALSE(report.is_due(99));
  EXPECT_TRUE(report.is_due(120));
  EXPECT_FALSE(report.is_due(120));
  EXPECT_FALSE(report.is_due(1199));
  EXPECT_TRUE(report.is_due(1200));
}

TEST(Tenfold, ReportsTheGreatestCountOnce) {
  Tenfold report(1);
  EXPECT_TRUE(report.is_due(UINT64_MAX / 2));
  EXPECT_FALSE(report.is_due(UINT64_MAX - 9));
}

}  // namespace
}  // namespace culprit::link
