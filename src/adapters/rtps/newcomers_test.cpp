#include "rtps/newcomers.h"

#include <gtest/gtest.h>

namespace culprit::rtps {
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

// A program has as many sockets as it likes.
TEST(Newcomers, OfAnotherComputerAreHundredsAtOnceAndThenThirtyASecond) {
  Newcomers newcomers;
  const auto from_thousands_of_sockets = [&](Ip ip, Duration at) {
    int count = 0;
    for (std::uint16_t port = 20'000; port < 30'000; ++port)
      count += newcomers.admits({ip, port}, Time(at)) ? 1 : 0;
    return count;
  };
  EXPECT_EQ(from_thousands_of_sockets(kMakesUp.ip, 1s), Newcomers::kAtOnceOfComputer);
  EXPECT_LE(from_thousands_of_sockets(kMakesUp.ip, 2s), 33);
  EXPECT_TRUE(newcomers.admits({{10, 0, 0, 6}, 40'000}, Time(2s))) << "each computer by itself";
  EXPECT_EQ(from_thousands_of_sockets({127, 0, 0, 1}, 2s), 10'000)
      << "the robot's may be among them";
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
    const auto high = static_cast<std::uint8_t>(i >> 8);
    newcomers.admits({{10, 1, high, static_cast<std::uint8_t>(i)}, 40'000}, Time(1s));
  }
  EXPECT_EQ(admitted(newcomers, kHonest, 1s, 100), 100);
  EXPECT_EQ(admitted(newcomers, kHonest, 60s, 100), Newcomers::kAtOnce) << "the others are quiet";
}

}  // namespace
}  // namespace culprit::rtps
