#include "robot/inbox.h"

#include <thread>

#include <gtest/gtest.h>

namespace culprit {
namespace {

using namespace std::chrono_literals;

TEST(Inbox, HandsOverInOrder) {
  Inbox inbox;
  inbox.put(SampleArrived{TopicId(0), 1}, Urgency::kSoon);
  inbox.put(SampleArrived{TopicId(1), 1});
  std::vector<Observation> taken;
  inbox.take(kNever, taken);
  ASSERT_EQ(taken.size(), 2u);
  EXPECT_EQ(std::get<SampleArrived>(taken[0].what).topic, TopicId(0));
  EXPECT_LE(taken[0].at, taken[1].at);
}

TEST(Inbox, WaitsNotLongForWhatIsNotUrgent) {
  Inbox inbox;
  inbox.put(SampleArrived{TopicId(0), 1}, Urgency::kSoon);
  std::vector<Observation> taken;
  inbox.take(kNever, taken);
  EXPECT_EQ(taken.size(), 1u);
}

TEST(Inbox, ReturnsAtItsTimeWithNothing) {
  Inbox inbox;
  std::vector<Observation> taken;
  inbox.take(live_now() + 1ms, taken);
  inbox.take(kLongAgo, taken);
  EXPECT_TRUE(taken.empty());
}

TEST(Inbox, WakesWhoeverWaits) {
  Inbox inbox;
  std::thread other([&] { inbox.put(LinkTrouble{"x"}); });
  std::vector<Observation> taken;
  inbox.take(kNever, taken);
  EXPECT_EQ(taken.size(), 1u);
  other.join();
}

TEST(Inbox, CanBeInterruptedBeforeOrWhileItWaits) {
  Inbox inbox;
  inbox.interrupt();
  std::vector<Observation> taken;
  inbox.take(kNever, taken);
  std::thread other([&] { inbox.interrupt(); });
  inbox.take(kNever, taken);
  other.join();
  EXPECT_TRUE(taken.empty());
}

TEST(Inbox, DropsTheOldestInAFloodButNeverAReply) {
  Inbox inbox;
  inbox.put(Reply{{7}, Outcome::kDone, {}, ""});
  for (std::size_t i = 0; i < Inbox::kMaxWaiting + 10; ++i)
    inbox.put(SampleArrived{TopicId(0), 1}, Urgency::kSoon);
  EXPECT_EQ(inbox.dropped(), 11u);
  std::vector<Observation> taken;
  inbox.take(kNever, taken);
  EXPECT_EQ(taken.size(), Inbox::kMaxWaiting);
  EXPECT_TRUE(std::holds_alternative<Reply>(taken[0].what));
}

}  // namespace
}  // namespace culprit
