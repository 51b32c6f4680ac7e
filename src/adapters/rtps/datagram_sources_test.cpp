#include "rtps/datagram_sources.h"

#include <algorithm>
#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rtps/test_datagram.h"

namespace culprit::rtps {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

using Datagram = std::vector<std::uint8_t>;

constexpr UdpAddress kHere{{127, 0, 0, 1}, 1000};
constexpr UdpAddress kThere{{203, 0, 113, 1}, 2000};

GuidPrefix prefix(std::size_t number) {
  GuidPrefix p;
  for (std::size_t i = 0; i < 4; ++i) p.bytes[i] = static_cast<std::uint8_t>(number >> (8 * i));
  return p;
}

Datagram from(const GuidPrefix& sender) {
  Datagram bytes = {'R', 'T', 'P', 'S', 2, 3, 1, 15};
  bytes.insert(bytes.end(), sender.bytes.begin(), sender.bytes.end());
  return bytes;
}

void add(Datagram& datagram, std::uint8_t id, std::uint8_t length, const Datagram& body) {
  datagram.insert(datagram.end(), {id, 1, length, 0});
  datagram.insert(datagram.end(), body.begin(), body.end());
}

void add_info_source(Datagram& datagram, const GuidPrefix& sender) {
  Datagram body = {0, 0, 0, 0, 2, 3, 1, 15};
  body.insert(body.end(), sender.bytes.begin(), sender.bytes.end());
  add(datagram, 0x0c, 20, body);
}

constexpr Time kNow{std::chrono::hours(1)};

TEST(DatagramSources, KnowWhenEachWasHeardLast) {
  DatagramSources sources;
  sources.heard(from(prefix(1)), kHere, kNow);
  sources.heard(from(prefix(1)), kThere, kNow + std::chrono::seconds(1));
  EXPECT_EQ(sources.last_of(prefix(1)), kNow + std::chrono::seconds(1));
  EXPECT_EQ(sources.last_of(prefix(2)), kLongAgo);
  sources.forget(prefix(1));
  EXPECT_EQ(sources.last_of(prefix(1)), kLongAgo);
}

TEST(DatagramSources, AreKnownByTheHeader) {
  DatagramSources sources;
  sources.heard(from(prefix(1)), kHere, kNow);
  sources.heard(from(prefix(1)), kHere, kNow);
  sources.heard(from(prefix(1)), kThere, kNow);
  EXPECT_THAT(sources.of(prefix(1)).addresses, ElementsAre(kHere, kThere));
  EXPECT_TRUE(sources.of(prefix(1)).is_complete);
  EXPECT_FALSE(sources.of(prefix(2)).is_complete) << "no datagram came from it";
}

TEST(DatagramSources, ASpeakerInAnothersNameIsWrittenDown) {
  DatagramSources sources;
  Datagram datagram = from(prefix(1));
  add(datagram, 0x09, 8, Datagram(8));
  add_info_source(datagram, prefix(2));
  sources.heard(datagram, kThere, kNow);
  EXPECT_THAT(sources.of(prefix(1)).addresses, ElementsAre(kThere));
  EXPECT_THAT(sources.of(prefix(2)).addresses, ElementsAre(kThere));
}

TEST(DatagramSources, AnOddLengthHidesNothing) {
  for (const std::size_t padding : {0, 1, 2, 3}) {
    DatagramSources sources;
    Datagram datagram = from(prefix(1));
    add(datagram, 0x80, 5, Datagram(5 + padding));
    add_info_source(datagram, prefix(2));
    sources.heard(datagram, kThere, kNow);
    EXPECT_THAT(sources.of(prefix(2)).addresses, ElementsAre(kThere)) << padding;
  }
}

TEST(DatagramSources, WhatIsNoDatagramOfRtpsSaysNothing) {
  DatagramSources sources;
  Datagram datagram = from(prefix(1));
  sources.heard({datagram.data(), 19}, kHere, kNow);
  datagram[0] = 'X';
  sources.heard(datagram, kHere, kNow);
  sources.heard({}, kHere, kNow);
  EXPECT_THAT(sources.of(prefix(1)).addresses, IsEmpty());
}

TEST(DatagramSources, EveryCutOfADatagramIsRead) {
  Datagram datagram = from(prefix(1));
  add(datagram, 0x15, 7, Datagram(7));
  add_info_source(datagram, prefix(2));
  for (std::size_t size = 0; size <= datagram.size(); ++size) {
    const Datagram cut(datagram.begin(), datagram.begin() + static_cast<std::ptrdiff_t>(size));
    DatagramSources().heard(cut, kHere, kNow);
  }
}

TEST(DatagramSources, StrangersDoNotDisplaceKnownSources) {
  DatagramSources sources;
  sources.heard(from(prefix(1)), kThere, kNow);
  sources.keep(prefix(1));
  for (std::size_t i = 2; i < 3 * DatagramSources::kMostOthers; ++i)
    sources.heard(from(prefix(i)), kHere, kNow);
  EXPECT_THAT(sources.of(prefix(1)).addresses, ElementsAre(kThere));
  EXPECT_THAT(sources.of(prefix(2)).addresses, IsEmpty()) << "the oldest makes room";
  sources.keep(prefix(2));
  sources.heard(from(prefix(2)), kHere, kNow);
  EXPECT_FALSE(sources.of(prefix(2)).is_complete) << "the lost ones are unknown";
  sources.forget(prefix(1));
  EXPECT_THAT(sources.of(prefix(1)).addresses, IsEmpty());
}

TEST(DatagramSources, AKnownSourceReportsNothingElse) {
  using Entity = std::array<std::uint8_t, 4>;
  constexpr Entity kOfParticipants = {0, 1, 0, 0xc2};
  constexpr Entity kOfEndpoints = {0, 0, 3, 0xc2};
  const auto writer = [](std::size_t sender, const Entity& entity) {
    Guid guid;
    const GuidPrefix of = prefix(sender);
    std::ranges::copy(of.bytes, guid.bytes.begin());
    std::ranges::copy(entity, guid.bytes.begin() + 12);
    return guid;
  };
  const auto announced = [&](std::size_t sender) {
    return TestDatagram(prefix(sender)).data(writer(sender, kOfParticipants), 1);
  };
  const Guid announcer = writer(1, kOfParticipants);
  DatagramSources sources;
  sources.heard(announced(1).bytes(), kThere, kNow);
  EXPECT_FALSE(sources.is_still_there(announced(1).bytes())) << "it is not discovered yet";
  sources.keep(prefix(1));
  EXPECT_TRUE(sources.is_still_there(announced(1).bytes()));
  EXPECT_FALSE(sources.is_still_there(announced(2).bytes()));
  sources.begin(prefix(2));
  EXPECT_TRUE(sources.is_still_there(announced(2).bytes())) << "it is our own";

  const Bytes some(8);
  EXPECT_TRUE(sources.is_still_there(TestDatagram(prefix(1))
                                         .submessage(0x09, 0, some)
                                         .data(announcer, 1)
                                         .submessage(0x80, 0, some)
                                         .bytes()));
  EXPECT_FALSE(sources.is_still_there(TestDatagram(prefix(1)).bytes()));
  EXPECT_FALSE(
      sources.is_still_there(TestDatagram(prefix(1)).data(writer(1, kOfEndpoints), 1).bytes()))
      << "of an endpoint";
  EXPECT_FALSE(sources.is_still_there(announced(1).heartbeat(announcer, 1, 1).bytes()));
  EXPECT_FALSE(sources.is_still_there(announced(1).submessage(0x0c, 0, Bytes(20)).bytes()))
      << "in the name of another one";
  EXPECT_FALSE(
      sources.is_still_there(TestDatagram(prefix(1)).farewell(announcer, 1, announcer).bytes()));
  const Bytes whole = announced(1).bytes();
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(sources.is_still_there(std::span(whole).first(size))) << size;
  sources.forget(prefix(1));
  EXPECT_FALSE(sources.is_still_there(announced(1).bytes()));
}

TEST(DatagramSources, TooManyAddressesAreKnownToBeTooMany) {
  DatagramSources sources;
  for (std::uint16_t port = 1; port <= DatagramSources::kMostAddresses + 1; ++port)
    sources.heard(from(prefix(1)), {{127, 0, 0, 1}, port}, kNow);
  EXPECT_EQ(sources.of(prefix(1)).addresses.size(), DatagramSources::kMostAddresses);
  EXPECT_FALSE(sources.of(prefix(1)).is_complete);
}

TEST(DatagramSources, TellSinceWhenNothingOfOurOwnCameThroughAPort) {
  DatagramSources sources;
  const auto at = [](int seconds) { return Time(std::chrono::seconds(seconds)); };
  sources.came_through(from(prefix(1)), 7410, at(1));
  EXPECT_EQ(sources.own_came_through(), kNever) << "our own id is not known yet";
  sources.begin(prefix(1));
  sources.came_through(from(prefix(2)), 7410, at(2));
  sources.came_through({}, 7410, at(2));
  EXPECT_EQ(sources.own_came_through(), kNever);
  sources.came_through(from(prefix(1)), 7410, at(3));
  sources.came_through(from(prefix(1)), 7411, at(4));
  EXPECT_EQ(sources.own_came_through(), at(3));
  sources.came_through(from(prefix(1)), 7411, at(9));
  sources.came_through(from(prefix(2)), 7410, at(9));
  EXPECT_EQ(sources.own_came_through(), at(3)) << "what others send is no witness";
  sources.came_through(from(prefix(1)), 7410, at(10));
  EXPECT_EQ(sources.own_came_through(), at(9));
}

}  // namespace
}  // namespace culprit::rtps
