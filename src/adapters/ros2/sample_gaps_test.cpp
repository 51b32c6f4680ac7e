#include "ros2/sample_gaps.h"

#include <limits>

#include <gtest/gtest.h>

namespace culprit::ros2 {
namespace {

rtps::Guid writer(int number) {
  rtps::Guid guid;
  guid.bytes[0] = static_cast<std::uint8_t>(number);
  guid.bytes[1] = static_cast<std::uint8_t>(number >> 8);
  return guid;
}

TEST(SampleGaps, AreCountedForEachWriter) {
  SampleGaps gaps;
  EXPECT_EQ(gaps.next(writer(1), 70, 0).published, 1u) << "nobody knows what came before";
  EXPECT_EQ(gaps.next(writer(2), 5, 0).published, 1u);
  EXPECT_EQ(gaps.next(writer(1), 73, 0).published, 3u);
  EXPECT_EQ(gaps.next(writer(2), 6, 0).published, 1u);
  EXPECT_FALSE(gaps.next(writer(1), 75, 0).lost_here);
}

TEST(SampleGaps, MayBeOurOwnIfWeDroppedMeanwhile) {
  SampleGaps gaps;
  gaps.next(writer(1), 1, 7);
  gaps.next(writer(2), 1, 7);
  EXPECT_FALSE(gaps.next(writer(1), 2, 9).lost_here) << "nothing of it is missing";
  EXPECT_FALSE(gaps.next(writer(1), 4, 9).lost_here) << "it was lost later";
  EXPECT_TRUE(gaps.next(writer(2), 3, 9).lost_here);
}

TEST(SampleGaps, BelieveNoImpossibleNumber) {
  SampleGaps gaps;
  constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
  gaps.next(writer(1), kLeast, 0);
  EXPECT_EQ(gaps.next(writer(1), std::numeric_limits<std::int64_t>::max(), 0).published, 1u);
  EXPECT_EQ(gaps.next(writer(1), kLeast, 0).published, 1u);
  EXPECT_EQ(gaps.next(writer(1), kLeast + 2000, 0).published, 1u) << "it began anew";
}

TEST(SampleGaps, OfManyWritersAreForgotten) {
  SampleGaps gaps;
  for (int i = 0; i < 5000; ++i) gaps.next(writer(i), 1, 0);
  EXPECT_EQ(gaps.next(writer(0), 9, 0).published, 1u);
}

}  // namespace
}  // namespace culprit::ros2
