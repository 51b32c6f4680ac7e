#include "link/newest_message.h"

#include <gtest/gtest.h>

#include "link/map_watch.h"

namespace culprit::link {
namespace {

using namespace std::chrono_literals;

TEST(NewestMessage, OfAPathOrScanIsRefusedIfItIsTooLarge) {
  const rtps::Bytes large(MapWatch::kMostBytesOfOthers + 1);
  const rtps::Bytes small(100);
  std::uint64_t messages = 0;
  NewestMessage newest;
  newest.keep("/plan", small, MapWatch::kMostBytesOfOthers, Time(1s), messages);
  newest.keep("/other", large, MapWatch::kMostBytesOfOthers, Time(2s), messages);
  EXPECT_EQ(newest.refused, large.size());
  EXPECT_EQ(newest.topic, "/plan");
  EXPECT_EQ(newest.payload, small) << "it takes no memory";
  EXPECT_EQ(newest.number, 1u);
  newest.keep("/plan", small, MapWatch::kMostBytesOfOthers, Time(3s), messages);
  EXPECT_EQ(newest.refused, 0u);
  EXPECT_EQ(newest.number, 2u);
  EXPECT_LT(MapWatch::kMostBytesOfOthers, MapWatch::kMostBytes) << "they are decoded each time";
}

}  // namespace
}  // namespace culprit::link
