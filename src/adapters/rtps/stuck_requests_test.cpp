#include "rtps/stuck_requests.h"

#include <gtest/gtest.h>

#include "rtps/for_each_submessage.h"
#include "rtps/test_datagram.h"

namespace culprit::rtps {
namespace {

constexpr GuidPrefix kUs{{1, 15, 9}};
constexpr GuidPrefix kPeer{{1, 15, 7, 7}};

// A request of ours: the numbers `first` to 17 are missing at the reader of this announcer.
Bytes request(std::uint8_t first, std::uint8_t count, const GuidPrefix& to = kPeer,
              std::uint8_t announcer = 3) {
  const Bytes destination(to.bytes.begin(), to.bytes.end());
  const Bytes body = {0, 0, announcer, 0xc7, 0, 0, announcer, 0xc2, 0, 0, 0,     0, first, 0,
                      0, 0, 17,        0,    0, 0, 0xff,      0xff, 0, 0, count, 0, 0,     0};
  return TestDatagram(kUs)
      .submessage(kInfoDestination, 0, destination)
      .submessage(kAckNack, 0x02, body)
      .bytes();
}

int mended_of(StuckRequests& requests, int times, const GuidPrefix& to = kPeer) {
  int mended = 0;
  for (int i = 0; i < times; ++i)
    mended += requests.mended(request(1, static_cast<std::uint8_t>(i), to)).empty() ? 0 : 1;
  return mended;
}

TEST(StuckRequests, AskForAllWhenTheyAreRepeatedInVain) {
  StuckRequests requests;
  requests.begin();
  for (int i = 1; i < StuckRequests::kTimes; ++i)
    EXPECT_TRUE(requests.mended(request(1, 40)).empty());
  const Bytes mended = requests.mended(request(1, 43));
  ASSERT_EQ(mended.size(), request(1, 43).size());
  std::vector<Bytes> all;
  for_each_submessage(mended, [&](ByteView each) { all.emplace_back(each.begin(), each.end()); });
  ASSERT_EQ(all.size(), 3U);
  const Bytes wanted = {kAckNack, 0x01, 24, 0, 0, 0, 3, 0xc7, 0, 0, 3,  0xc2, 0, 0,
                        0,        0,    0,  0, 0, 0, 0, 0,    0, 0, 43, 0,    0, 0};
  EXPECT_EQ(all[1], wanted) << "the count stays, and an answer is asked for";
  EXPECT_EQ(all[2][0], kPad);
  EXPECT_EQ(mended_of(requests, 8), 2) << "again and again";
}

TEST(StuckRequests, GoOutAsTheyAreWhileTheyMakeProgress) {
  StuckRequests requests;
  requests.begin();
  for (std::uint8_t first = 1; first <= 200; ++first)
    EXPECT_TRUE(requests.mended(request(first, first)).empty());
}

TEST(StuckRequests, AreCountedForEachWriter) {
  StuckRequests requests;
  requests.begin();
  for (std::uint8_t number = 0; number < 100; ++number) {
    const GuidPrefix other{{1, 15, 8, number}};
    EXPECT_TRUE(requests.mended(request(1, 1, other)).empty());
    EXPECT_TRUE(requests.mended(request(1, 1, other, 4)).empty());
  }
}

TEST(StuckRequests, ToOtherVendorsAndProgramsStay) {
  StuckRequests requests;
  EXPECT_EQ(mended_of(requests, 20), 0) << "datagrams may be signed";
  requests.begin();
  EXPECT_EQ(mended_of(requests, 20, GuidPrefix{{1, 16, 7}}), 0);
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(requests.mended(request(1, 1, kPeer, 9)).empty());
}

TEST(StuckRequests, OfEveryCutOfADatagramAreRead) {
  StuckRequests requests;
  requests.begin();
  const Bytes whole = request(1, 1);
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_TRUE(requests.mended(ByteView(whole).first(size)).empty());
}

}  // namespace
}  // namespace culprit::rtps
