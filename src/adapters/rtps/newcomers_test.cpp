#include "rtps/newcomers.h"

#include <gtest/gtest.h>

namespace culprit::ros2 {
namespace {

using namespace std::chrono_literals;

constexpr UdpAddress kMakesUp{{10, 0, 0, 5}, 40'000};
constexpr UdpAddress kHonest{{10, 0, 0, 5}, 40'001};

int admitted(Newcomers& newcomers, const UdpAddress& from, Duration at, int wanted) {
  int count = 0;
  for (int i = 0; i < wanted; ++i) count += newcomers.admits(from, Time(at)) ? 1 : 0;
  return count;
}

TEST(Newcomers, OfOneSourceAreAFewAtOnceAndThenFourASecond) {
  Newcomers newcomers;
  EXPECT_EQ(admitted(newcomers, kMakesUp, 1s, 1000), Newcomers::kAtOnce);
  EXPECT_EQ(admitted(newcomers, kMakesUp, 2s, 1000), 4);
  EXPECT_EQ(admitted(newcomers, kMakesUp, 3s, 1000), 4);
  EXPECT_EQ(admitted(newcomers, kMakesUp, 60s, 1000), Newcomers::kAtOnce);
}

TEST(Newcomers, OfOneSourceKeepThoseOfOthersNotOut) {
  Newcomers newcomers;
  admitted(newcomers, kMakesUp, 1s, 1000);
  EXPECT_TRUE(newcomers.admits(kHonest, Time(1s)));
}

TEST(Newcomers, AreOthersThanOurselves) {
  Newcomers newcomers;
  const GuidPrefix self{{1, 2}};
  EXPECT_FALSE(newcomers.is_self(self));
  newcomers.begin(self);
  EXPECT_TRUE(newcomers.is_self(self));
  EXPECT_FALSE(newcomers.is_self({{1, 3}}));
}

TEST(Newcomers, OfMoreSourcesThanAreCountedAreNotKeptOut) {
  Newcomers newcomers;
  for (std::size_t i = 0; i < 10 * Newcomers::kMostSources; ++i) {
    const auto high = static_cast<std::uint8_t>(i >> 16);
    newcomers.admits({{10, 1, 1, high}, static_cast<std::uint16_t>(i)}, Time(1s));
  }
  EXPECT_EQ(admitted(newcomers, kHonest, 1s, 100), 100);
  EXPECT_EQ(admitted(newcomers, kHonest, 60s, 100), Newcomers::kAtOnce) << "the others are quiet";
}

}  // namespace
}  // namespace culprit::ros2
