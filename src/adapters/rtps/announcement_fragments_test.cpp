#include "rtps/announcement_fragments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rtps/claims.h"
#include "rtps/test_datagram.h"

namespace culprit::rtps {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr GuidPrefix kSpeaker{{4, 4}};
constexpr GuidPrefix kForeign{{5, 5}};
constexpr UdpAddress kSpeaksFrom{{10, 0, 0, 5}, 7410};
constexpr std::uint16_t kSizeOfPart = 32;  // bytes of a fragment
constexpr std::uint8_t kPadding = 1;

Guid entity_of(const GuidPrefix& prefix, std::array<std::uint8_t, 4> entity) {
  Guid all;
  std::copy(prefix.bytes.begin(), prefix.bytes.end(), all.bytes.begin());
  std::copy(entity.begin(), entity.end(), all.bytes.begin() + 12);
  return all;
}
Guid its_announcer() { return entity_of(kSpeaker, {0, 1, 0, 0xc2}); }

// It announces another participant than its sender. The key is not in the first fragment.
Bytes announcement_in_parts() {
  const Guid other = entity_of(kForeign, {0, 0, 1, 0xc1});
  Bytes payload{0, 3, 0, 0};
  const Bytes list = TestParameters()
                         .add(0x2c, std::string_view("forty bytes and more, so that it is long"))
                         .add(0x50, Bytes(other.bytes.begin(), other.bytes.end()))
                         .end();
  payload.insert(payload.end(), list.begin(), list.end());
  return payload;
}

class Fragments : public testing::Test {
 protected:
  Fragments() { fragments.begin(); }

  Bytes part(std::uint32_t number, std::int64_t sequence = 7) const {
    return TestDatagram(kSpeaker)
        .part(its_announcer(), sequence, number, kSizeOfPart, announcement_in_parts())
        .heartbeat(its_announcer(), 1, sequence)
        .bytes();
  }
  std::vector<Bytes> take(Bytes datagram, const UdpAddress& from = kSpeaksFrom) {
    last = std::move(datagram);
    return fragments.take(last, from);
  }

  AnnouncementFragments fragments;
  Bytes last;  // after something was taken out
};

TEST_F(Fragments, OfAnAnnouncementBecomeOneDatagram) {
  EXPECT_THAT(take(part(3)), IsEmpty());
  EXPECT_THAT(take(part(1)), IsEmpty());
  EXPECT_THAT(take(part(1)), IsEmpty()) << "it came twice";
  const auto whole = take(part(2));
  ASSERT_EQ(whole.size(), 1u);
  const Bytes same = TestDatagram(kSpeaker)
                         .submessage(0x0e, 0, Bytes(12))
                         .sample(its_announcer(), 7, announcement_in_parts())
                         .bytes();
  EXPECT_EQ(whole[0], same);
  EXPECT_THAT(others_announced(whole[0]), ElementsAre(kForeign));
}

TEST_F(Fragments, AreKeptFromTheMiddleware) {
  take(part(1));
  EXPECT_EQ(last.size(), part(1).size());
  EXPECT_EQ(last[20], kPadding);
  Bytes without_length = TestDatagram(kSpeaker)
                             .part(its_announcer(), 7, 1, kSizeOfPart, announcement_in_parts())
                             .bytes();
  without_length[22] = 0;
  take(without_length);
  EXPECT_EQ(last[20], kPadding);
  EXPECT_EQ(last[22], last.size() - 24) << "what is in it begins no submessage";
}

TEST_F(Fragments, OfOtherSamplesAreLeftAlone) {
  const Guid camera = entity_of(kSpeaker, {0, 0, 5, 3});
  const Bytes datagram = TestDatagram(kSpeaker).fragment(camera, 1, 1, 1000, 5000).bytes();
  EXPECT_THAT(take(datagram), IsEmpty());
  EXPECT_EQ(last, datagram);
}

TEST_F(Fragments, InASecuredDomainAreLeftAlone) {
  AnnouncementFragments not_begun;
  Bytes datagram = part(1);
  EXPECT_THAT(not_begun.take(datagram, kSpeaksFrom), IsEmpty());
  EXPECT_EQ(datagram, part(1));
}

TEST_F(Fragments, OfOneSocketMakeRoomForOneAnother) {
  take(part(1));
  for (std::int64_t sequence = 8; sequence < 200; ++sequence)
    take(part(1, sequence), {{10, 0, 0, 6}, 9});
  take(part(2));
  EXPECT_EQ(take(part(3)).size(), 1u) << "another one's did not displace it";
  take(part(1));
  for (std::size_t i = 0; i < AnnouncementFragments::kMostOfSocket; ++i)
    take(part(1, 8 + static_cast<std::int64_t>(i)));
  take(part(2));
  EXPECT_THAT(take(part(3)), IsEmpty());
}

TEST_F(Fragments, ThatAreDamagedOrTooLargeAreDropped) {
  const auto writer = its_announcer();
  EXPECT_THAT(take(TestDatagram(kSpeaker).fragment(writer, 1, 1, 65'000, 65'000).bytes()),
              IsEmpty());
  EXPECT_THAT(take(TestDatagram(kSpeaker).fragment(writer, 1, 0, 10, 10).bytes()), IsEmpty());
  EXPECT_THAT(take(TestDatagram(kSpeaker).fragment(writer, 1, 1, 0, 10).bytes()), IsEmpty());
  EXPECT_THAT(take(TestDatagram(kSpeaker).fragment(writer, 1, 3, 10, 20).bytes()), IsEmpty());
  EXPECT_THAT(take(TestDatagram(kSpeaker).fragment(writer, 1, 0xffff'ffff, 0xffff, 20).bytes()),
              IsEmpty());
  EXPECT_EQ(last[20], kPadding);
  const Bytes whole = part(1);
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THAT(take(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))),
                IsEmpty());
}

}  // namespace
}  // namespace culprit::rtps
