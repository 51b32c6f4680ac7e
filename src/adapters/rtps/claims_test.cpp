#include "rtps/claims.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rtps/test_datagram.h"

namespace culprit::rtps {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr GuidPrefix kSender{{1, 1}};
constexpr GuidPrefix kOther{{2, 2}};
constexpr GuidPrefix kThird{{3, 3}};

Guid guid(const GuidPrefix& prefix, std::array<std::uint8_t, 4> entity) {
  Guid all;
  std::copy(prefix.bytes.begin(), prefix.bytes.end(), all.bytes.begin());
  std::copy(entity.begin(), entity.end(), all.bytes.begin() + 12);
  return all;
}
Guid of_writers() { return guid(kSender, {0, 0, 3, 0xc2}); }
Guid of_participants() { return guid(kSender, {0, 1, 0, 0xc2}); }

TEST(Claims, OfItselfAreNone) {
  const Guid own = guid(kSender, {0, 0, 5, 3});
  EXPECT_THAT(others_announced(TestDatagram(kSender).farewell(of_writers(), 1, own).bytes()),
              IsEmpty());
  EXPECT_THAT(
      others_announced(TestDatagram(kSender)
                           .announcement(of_writers(), 1, TestParameters().endpoint(own).end())
                           .bytes()),
      IsEmpty());
}

TEST(Claims, OfParticipantsIntroduceThem) {
  const Bytes nothing = TestParameters().end();
  EXPECT_TRUE(introduces(TestDatagram(kSender)
                             .heartbeat(of_writers(), 1, 1)
                             .announcement(of_participants(), 1, nothing)
                             .bytes()));
  EXPECT_TRUE(introduces(
      TestDatagram(kSender).announcement(guid(kSender, {0xff, 1, 1, 0xc2}), 1, nothing).bytes()));
  EXPECT_FALSE(introduces(TestDatagram(kSender).announcement(of_writers(), 1, nothing).bytes()));
  EXPECT_FALSE(introduces(TestDatagram(kSender).heartbeat(of_participants(), 1, 1).bytes()));
}

TEST(Claims, OfAThousandSubmessagesAreTooMany) {
  TestDatagram many(kSender);
  for (int i = 0; i < kMostSubmessages; ++i) many.submessage(0x01, 0, {});
  EXPECT_FALSE(has_too_many_submessages(many.bytes()));
  EXPECT_TRUE(has_too_many_submessages(many.submessage(0x01, 0, {}).bytes()));
}

// Behind an odd length, each byte may begin a submessage that names another source.
TEST(Claims, OfMoreParticipantsThanARelayHasAreTooMany) {
  const Bytes source = {0, 0, 0, 0, 2, 3, 1, 15, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  TestDatagram datagram(kSender);
  for (int i = 1; i < kMostSpeakers; ++i) datagram.submessage(0x0c, 0, source);
  EXPECT_FALSE(has_too_many_speakers(datagram.bytes()));
  EXPECT_TRUE(has_too_many_speakers(datagram.submessage(0x0c, 0, source).bytes()));
  Bytes odd = TestDatagram(kSender).bytes();
  odd.insert(odd.end(), {0x01, 1, 1, 0, 0});
  odd.resize(60'000, 0x0c);
  EXPECT_TRUE(has_too_many_speakers(odd));
  EXPECT_FALSE(has_too_many_speakers(Bytes(60'000, 0x0c))) << "it is no message";
}

TEST(Claims, AreWhatEndsAndWhatBegins) {
  const Guid other = guid(kOther, {0, 0, 5, 3});
  const Guid third = guid(kThird, {0, 0, 1, 0xc1});
  EXPECT_THAT(others_announced(TestDatagram(kSender).farewell(of_writers(), 1, other).bytes()),
              ElementsAre(kOther));
  const Bytes key(third.bytes.begin(), third.bytes.end());
  EXPECT_THAT(others_announced(
                  TestDatagram(kSender)
                      .heartbeat(of_writers(), 1, 1)
                      .announcement(of_participants(), 1, TestParameters().add(0x50, key).end())
                      .announcement(of_writers(), 1, TestParameters().endpoint(other).end())
                      .bytes()),
              ElementsAre(kThird, kOther));
}

// Fast DDS ignores the first byte, and takes the 16 bytes behind the number of a key, whatever length the list gives.
TEST(Claims, AreReadAsTheMiddlewareReadsThem) {
  const Guid other = guid(kOther, {0, 0, 1, 0xc1});
  const Bytes ends = TestParameters().add(0x71, Bytes{0, 0, 0, 3}).end();
  const auto claimed = [&](std::uint8_t first, std::uint8_t length) {
    Bytes payload{first, 3, 0, 0, 0x50, 0, length, length == 0xff ? length : std::uint8_t{0}};
    payload.insert(payload.end(), other.bytes.begin(), other.bytes.end());
    payload.insert(payload.end(), {1, 0, 0, 0});
    return others_announced(
        TestDatagram(kSender)
            .end_of(of_participants(), 1, ends, TestDatagram::Content::kPayload, payload)
            .bytes());
  };
  EXPECT_THAT(claimed(0, 16), ElementsAre(kOther));
  EXPECT_THAT(claimed(9, 16), ElementsAre(kOther));
  EXPECT_THAT(claimed(0, 0), ElementsAre(kOther));
  EXPECT_THAT(claimed(0, 4), ElementsAre(kOther));
  EXPECT_THAT(claimed(0, 0xff), ElementsAre(kOther)) << "longer than the list";
}

TEST(Claims, OfThousandsAreCounted) {
  TestParameters all;
  Guid each = guid(kOther, {0, 0, 1, 0xc1});
  for (int i = 0; i < 3000; ++i) {
    each.bytes[4] = static_cast<std::uint8_t>(i), each.bytes[5] = static_cast<std::uint8_t>(i >> 8);
    all.add(0x50, Bytes(each.bytes.begin(), each.bytes.end()));
  }
  EXPECT_EQ(
      others_announced(TestDatagram(kSender).announcement(of_participants(), 1, all.end()).bytes())
          .size(),
      kMostOthers + 1);
}

TEST(Claims, OfTheSourceThatIsNamedWithinTheDatagramAreItsOwn) {
  Bytes source = {0, 0, 0, 0, 2, 3, 1, 15};
  source.insert(source.end(), kOther.bytes.begin(), kOther.bytes.end());
  const Guid other = guid(kOther, {0, 0, 5, 3});
  EXPECT_THAT(others_announced(TestDatagram(kSender)
                                   .submessage(0x0c, 0, source)
                                   .farewell(of_writers(), 1, other)
                                   .bytes()),
              IsEmpty());
}

TEST(Claims, WhatProgramsWriteIsNone) {
  const Guid other = guid(kOther, {0, 0, 5, 3});
  EXPECT_THAT(others_announced(
                  TestDatagram(kSender).farewell(guid(kSender, {0, 0, 9, 3}), 1, other).bytes()),
              IsEmpty());
}

TEST(Claims, OfEveryCutOfADatagramAreRead) {
  const Guid other = guid(kOther, {0, 0, 5, 3});
  const Bytes whole = TestDatagram(kSender)
                          .farewell(of_writers(), 1, other)
                          .announcement(of_writers(), 1, TestParameters().endpoint(other).end())
                          .bytes();
  for (std::size_t size = 0; size < whole.size(); ++size)
    (void)others_announced(std::span(whole).first(size));
}

}  // namespace
}  // namespace culprit::rtps
