#include "recorder/message_ring.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit::recorder {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

RingMessage message_of(std::size_t bytes, Duration at, std::size_t topic = 0) {
  return {.topic = topic, .at = Time(at), .payload = rtps::Bytes(bytes)};
}

std::vector<std::size_t> sizes(const std::vector<SharedMessage>& messages) {
  std::vector<std::size_t> all;
  for (const SharedMessage& message : messages) all.push_back(message->payload.size());
  return all;
}

constexpr MessageRing::Limits kRoomy{1'000'000, 1'000'000, 1'000'000, 10s};
constexpr std::size_t kAll = 100'000'000;

TEST(MessageRing, ForgetsWhatIsTooOld) {
  MessageRing ring(kRoomy);
  ring.push(message_of(1, 0s), Share::kSmall);
  ring.push(message_of(2, 4s), Share::kLarge);
  ring.push(message_of(3, 11s), Share::kSmall);
  EXPECT_THAT(sizes(ring.after(0, kLongAgo, kAll)), ElementsAre(2, 3));
}

TEST(MessageRing, GivesWhatIsNewInTheOrderInWhichItCame) {
  MessageRing ring(kRoomy);
  ring.push(message_of(1, 1s), Share::kSmall);
  ring.push(message_of(2, 2s), Share::kLarge);
  ring.push(message_of(3, 3s), Share::kSmall);
  const auto first = ring.after(0, Time(2s), 1);
  EXPECT_THAT(sizes(first), ElementsAre(2));
  EXPECT_THAT(sizes(ring.after(first.back()->number, Time(2s), kAll)), ElementsAre(3));
}

TEST(MessageRing, KeepsTheLastWordOfALatchedTopicHoweverOldItIs) {
  MessageRing ring(kRoomy);
  const rtps::Guid one{{1}};
  const rtps::Guid other{{2}};
  ring.latch(message_of(1, 0s), one);
  ring.latch(message_of(2, 1s), other);
  ring.latch(message_of(3, 2s), one);
  ring.push(message_of(4, 1000s), Share::kSmall);
  EXPECT_THAT(sizes(ring.latched(Time(990s))), ElementsAre(2, 3));
}

TEST(MessageRing, CountsWhatIsLostBeforeItWasTaken) {
  constexpr std::size_t kRoom = 3 * (100 + MessageRing::kOverhead);
  MessageRing ring({kRoom, kRoom, kRoom, 10s});
  ring.push(message_of(100, 1s), Share::kSmall);
  ring.count_lost(Time(2s));
  for (int i = 0; i < 3; ++i) ring.push(message_of(100, 3s), Share::kSmall);
  EXPECT_EQ(ring.after(0, Time(2s), kAll).size(), 3);
  for (int i = 0; i < 5; ++i) ring.push(message_of(100, 3s), Share::kSmall);
  EXPECT_EQ(ring.stop_counting(), 2) << "three were taken, and three are still there";
}

// For messages in any order: each part holds no more than its room, the newest is held if it fits
// at all, and the numbers given ascend.
RC_GTEST_PROP(MessageRing, NeverHoldsMoreThanItMay, ()) {
  const MessageRing::Limits limits{*rc::gen::inRange<std::size_t>(0, 20'000),
                                   *rc::gen::inRange<std::size_t>(0, 20'000),
                                   *rc::gen::inRange<std::size_t>(0, 20'000), 10s};
  MessageRing ring(limits);
  std::uint64_t taken = 0;
  Duration now{};
  for (int i = 0, count = *rc::gen::inRange(0, 60); i < count; ++i) {
    now += std::chrono::milliseconds(*rc::gen::inRange(0, 3000));
    const auto bytes = *rc::gen::inRange<std::size_t>(0, 6000);
    const Share share = *rc::gen::element(Share::kSmall, Share::kLarge);
    const std::size_t room = share == Share::kSmall ? limits.small_bytes : limits.large_bytes;
    if (*rc::gen::arbitrary<bool>())
      ring.latch(message_of(bytes, now), rtps::Guid{{*rc::gen::inRange<std::uint8_t>(0, 4)}});
    ring.push(message_of(bytes, now), share);
    RC_ASSERT(ring.bytes(Share::kSmall) <= limits.small_bytes);
    RC_ASSERT(ring.bytes(Share::kLarge) <= limits.large_bytes);
    RC_ASSERT(ring.latched_bytes() <= limits.latched_bytes);
    RC_ASSERT((bytes + MessageRing::kOverhead <= room) ==
              (ring.bytes(share) >= bytes + MessageRing::kOverhead &&
               ring.after(0, Time(now), kAll).size() > 0 &&
               ring.after(0, Time(now), kAll).back()->payload.size() == bytes));
    if (*rc::gen::arbitrary<bool>()) {
      for (const SharedMessage& each : ring.after(taken, kLongAgo, kAll)) {
        RC_ASSERT(each->number > taken);
        taken = each->number;
        RC_ASSERT(each->at >= Time(now - limits.keep));
      }
    }
  }
}

}  // namespace
}  // namespace culprit::recorder
