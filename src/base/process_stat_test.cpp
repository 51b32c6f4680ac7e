#include "base/process_stat.h"

#include <unistd.h>

#include <gtest/gtest.h>

namespace culprit {
namespace {

TEST(ProcessStat, IsReadOfAProcessThatRuns) {
  const auto own = process_stat(std::to_string(getpid()));
  ASSERT_TRUE(own);
  EXPECT_EQ(own->state, 'R');
  EXPECT_GE(own->threads, 1u);
  EXPECT_GT(own->resident_bytes, 100'000u);
  EXPECT_GT(own->virtual_bytes, own->resident_bytes);
  EXPECT_GT(own->started_after_boot, 0);
  EXPECT_TRUE(process_stat("self"));
  EXPECT_FALSE(process_stat("-1"));
}

}  // namespace
}  // namespace culprit
