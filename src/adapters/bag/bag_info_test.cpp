#include "bag/bag_info.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bag/test_bag.h"

namespace culprit::bag {
namespace {

using test::BagTest;
using test::kBagStart;
using test::value_of;

std::vector<TopicInfo> topics_of(const std::filesystem::path& path) {
  BagFile file = value_of(BagFile::open(path));
  ros2::MessageLibrary library;
  BagInfo info(file.contents(), library);
  for (BagMessage message; file.next(message);) info.add(message);
  return info.topics();
}

TEST_F(BagTest, InfoHasTheRateAndTheLongestGapOfEachTopic) {
  test::TestRecording recording = test::regular_recording();
  recording.messages.erase(recording.messages.begin() + 100, recording.messages.begin() + 150);
  recording.types.emplace_back("/never", "std_msgs/msg/Float64");
  recording.types.emplace_back("/strange", "my_msgs/msg/Strange");
  recording.messages.push_back({kBagStart + 31'000 * test::kMillisecond, "/strange", "\0\1\0\0"});
  test::write_db3(folder_ / "a.db3", recording);
  const std::vector<TopicInfo> topics = topics_of(folder_ / "a.db3");
  ASSERT_EQ(topics.size(), 3u);
  EXPECT_EQ(topics[0].name, "/never");
  EXPECT_EQ(topics[0].messages, 0u);
  EXPECT_THAT(topics[1].why_undecoded, testing::HasSubstr("my_msgs/msg/Strange is not known"));
  EXPECT_EQ(topics[1].longest_gap, 31'000 * test::kMillisecond);
  EXPECT_EQ(topics[2].name, "/x");
  EXPECT_EQ(topics[2].messages, 250u);
  EXPECT_NEAR(topics[2].rate(), 249 / 29.9, 0.001);
  EXPECT_EQ(topics[2].longest_gap, 5100 * test::kMillisecond);
  EXPECT_EQ(topics[2].gap_at - kBagStart, 9900 * test::kMillisecond);
  EXPECT_EQ(topics[2].gap_clock, topics[2].gap_at);
  EXPECT_EQ(topics[2].why_undecoded, "");
}

TEST_F(BagTest, InfoCountsMessagesThatDoNotFitTheirType) {
  test::TestRecording recording = test::regular_recording();
  for (std::size_t m = 20; m < 30; ++m) recording.messages[m].bytes.resize(6);
  test::write_db3(folder_ / "a.db3", recording);
  const std::vector<TopicInfo> topics = topics_of(folder_ / "a.db3");
  EXPECT_EQ(topics[0].undecoded, 10u);
}

}  // namespace
}  // namespace culprit::bag
