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

TEST_F(BagTest, InfoLeavesHolesOfTheCopyOutOfRates) {
  const test::TestRecording whole = test::regular_recording();
  test::TestRecording part = whole;
  part.messages.resize(100);
  test::write_db3(folder_ / "a_0.db3", part);
  part.messages.assign(whole.messages.begin() + 200, whole.messages.end());
  test::write_db3(folder_ / "a_2.db3", part);
  test::write_metadata(folder_, {"a_0.db3", "a_1.db3", "a_2.db3"}, 300);
  const std::vector<TopicInfo> topics = topics_of(folder_);
  EXPECT_NEAR(topics[0].rate(), 10, 0.001);
  EXPECT_EQ(topics[0].longest_gap, 100 * test::kMillisecond);
}

TEST_F(BagTest, InfoGivesNoRateOfABurstOrASingleMessage) {
  test::TestRecording recording{{{"/x", "std_msgs/msg/Float64"}, {"/once", "std_msgs/msg/Float64"}},
                                {}};
  const std::string bytes(test::text_of(test::number(1)));
  for (int i = 0; i < 4; ++i)
    recording.messages.push_back({test::kBagStart + i * test::kMillisecond, "/x", bytes});
  test::write_db3(folder_ / "burst.db3", recording);
  EXPECT_EQ(topics_of(folder_ / "burst.db3")[1].rate(), 0);

  recording.messages.assign({{test::kBagStart, "/once", bytes}});
  test::write_db3(folder_ / "once.db3", recording);
  const std::vector<TopicInfo> topics = topics_of(folder_ / "once.db3");
  EXPECT_EQ(topics[0].gap_at, test::kBagStart);
  EXPECT_EQ(topics[0].gap_clock, test::kBagStart);
}

}  // namespace
}  // namespace culprit::bag
