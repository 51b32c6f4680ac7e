#include "bag/time_line.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace culprit::bag {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kStart = 1'700'000'000 * kSecond;

struct Written {
  std::size_t topic;
  std::int64_t at;
};

// At 10 Hz, from so many seconds until so many.
std::vector<Written> steady(double from, double until, std::size_t topic = 0) {
  std::vector<Written> all;
  for (std::int64_t t = static_cast<std::int64_t>(from * 10);
       t < static_cast<std::int64_t>(until * 10); ++t)
    all.push_back({topic, kStart + t * kSecond / 10});
  return all;
}

std::vector<Written> operator+(std::vector<Written> a, const std::vector<Written>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

struct Straight {
  std::vector<double> jumps;  // s
  double longest_gap = 0;     // s, between messages by their straightened times
  double lasts = 0;           // s
};

Straight straight(const std::vector<Written>& written) {
  PieceFinder finder;
  for (std::size_t i = 0; i < written.size(); ++i)
    finder.add(static_cast<std::int64_t>(i), written[i].topic, written[i].at);
  const TimeLine line = straighten(finder.pieces());
  std::vector<std::int64_t> times;
  for (std::size_t i = 0; i < written.size(); ++i)
    times.push_back(written[i].at + line.offset_of(static_cast<std::int64_t>(i)));
  std::sort(times.begin(), times.end());
  Straight result;
  for (const TimeLine::Jump& each : line.jumps)
    result.jumps.push_back(static_cast<double>(each.by) / kSecond);
  for (std::size_t i = 1; i < times.size(); ++i)
    result.longest_gap =
        std::max(result.longest_gap, static_cast<double>(times[i] - times[i - 1]) / kSecond);
  result.lasts = static_cast<double>(times.back() - times.front()) / kSecond;
  return result;
}

TEST(TimeLine, OfASteadyRecordingIsItsTimes) {
  const Straight line = straight(steady(0, 30));
  EXPECT_TRUE(line.jumps.empty());
  EXPECT_NEAR(line.lasts, 29.9, 1e-9);
}

TEST(TimeLine, KeepsASilenceOfTheRobot) {
  const Straight line = straight(steady(0, 10) + steady(15, 30));
  EXPECT_TRUE(line.jumps.empty());
  EXPECT_NEAR(line.longest_gap, 5.1, 1e-9);
}

TEST(TimeLine, GoesOnWhereTheClockWasSet) {
  for (const double by : {-3600.0, -40.0, -5.0, 3600.0, 86400.0 * 365}) {
    const Straight line = straight(steady(0, 15) + steady(15 + by, 30 + by));
    ASSERT_EQ(line.jumps.size(), 1u) << by;
    EXPECT_NEAR(line.jumps[0], by, 0.01);
    EXPECT_NEAR(line.longest_gap, 0.1, 0.01);
    EXPECT_NEAR(line.lasts, 29.9, 0.01);
  }
}

TEST(TimeLine, GoesOnWhereTheClockWasSetBackAndForwardAgain) {
  const Straight line = straight(steady(0, 10) + steady(-3590, -3580) + steady(20, 30));
  ASSERT_EQ(line.jumps.size(), 2u);
  EXPECT_NEAR(line.jumps[0], -3600, 0.01);
  EXPECT_NEAR(line.jumps[1], 3600, 0.01);
  EXPECT_NEAR(line.lasts, 29.9, 0.01);
}

TEST(TimeLine, SortsAFileWhoseChunksAreRearranged) {
  for (const auto& written : {steady(15, 30) + steady(0, 15),
                              steady(0, 10) + steady(20, 25) + steady(10, 20) + steady(25, 30),
                              steady(25, 30) + steady(20, 25) + steady(15, 20) + steady(10, 15) +
                                  steady(5, 10) + steady(0, 5)}) {
    const Straight line = straight(written);
    EXPECT_TRUE(line.jumps.empty());
    EXPECT_NEAR(line.longest_gap, 0.1, 1e-9);
    EXPECT_NEAR(line.lasts, 29.9, 1e-9);
  }
}

TEST(TimeLine, SortsAFileThatWasWrittenTopicByTopic) {
  const Straight line =
      straight(steady(0, 10, 1) + steady(15, 30, 1) + steady(0, 30, 2) + steady(0, 30, 3));
  EXPECT_TRUE(line.jumps.empty());
  EXPECT_NEAR(line.lasts, 29.9, 1e-9);
}

TEST(TimeLine, TopicsThatWereWrittenALittleLateAreNoJump) {
  std::vector<Written> written;
  for (int i = 0; i < 300; ++i) {
    written.push_back({1, kStart + i * kSecond / 10});
    written.push_back({2, kStart + i * kSecond / 10 - kSecond / 2});
  }
  EXPECT_TRUE(straight(written).jumps.empty());
}

}  // namespace
}  // namespace culprit::bag
