#include "inbox/inbox.h"

#include <atomic>
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

TEST(Inbox, WhatIsNotUrgentIsHandedOverTogether) {
  Inbox inbox;
  inbox.hand_over();  // nothing
  for (std::uint32_t i = 0; i < 3; ++i) inbox.put(SampleArrived{TopicId(i), 1}, Urgency::kSoon);
  inbox.hand_over();
  std::vector<Observation> taken;
  inbox.take(kNever, taken);
  EXPECT_EQ(taken.size(), 3u);
}

TEST(Inbox, WhatIsNotUrgentIsHandedOverAgainAndAgain) {
  Inbox inbox;
  std::vector<Observation> taken;
  for (std::size_t i = 1; i <= 3; ++i) {
    std::atomic<bool> is_taken = false;
    std::thread rounds([&] {
      inbox.put(SampleArrived{TopicId(0), 1}, Urgency::kSoon);
      while (!is_taken) {
        inbox.hand_over();
        std::this_thread::sleep_for(1ms);
      }
    });
    inbox.take(kNever, taken);
    is_taken = true;
    rounds.join();
    EXPECT_EQ(taken.size(), i);
  }
}

TEST(Inbox, ALookGetsObservationsThatAreNotUrgent) {
  Inbox inbox;
  inbox.put(SampleArrived{TopicId(0), 1}, Urgency::kSoon);
  std::vector<Observation> taken;
  inbox.take(live_now(), taken);
  EXPECT_EQ(taken.size(), 1u);
}

TEST(Inbox, ReturnsAtItsTimeWithNothing) {
  Inbox inbox;
  std::vector<Observation> taken;
  inbox.take(live_now() + 1ms, taken);
  inbox.take(kLongAgo, taken);
  EXPECT_TRUE(taken.empty());
}

TEST(Inbox, WakesAWaitingReader) {
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

TEST(Inbox, DropsSamplesAloneInAFloodAndReportsHowMany) {
  Inbox inbox;
  inbox.put(NodeVanished{"/camera"});
  for (std::size_t i = 0; i < Inbox::kMaxWaiting; ++i) inbox.put(SampleArrived{TopicId(0), 1});
  inbox.put(Reply{});
  std::vector<Observation> taken;
  inbox.take(kNever, taken);
  EXPECT_LE(taken.size(), Inbox::kMaxWaiting);
  EXPECT_TRUE(std::holds_alternative<NodeVanished>(taken[0].what));
  EXPECT_TRUE(std::holds_alternative<Reply>(taken[taken.size() - 2].what));
  const auto* told = std::get_if<LinkTrouble>(&taken.back().what);
  ASSERT_NE(told, nullptr);
  const std::size_t dropped = Inbox::kMaxWaiting + 3 - taken.size();  // one of `taken` reports them
  EXPECT_NE(told->text.find("dropped " + std::to_string(dropped) + " messages"), std::string::npos)
      << told->text;
  taken.clear();
  inbox.put(Reply{});
  inbox.take(kNever, taken);
  EXPECT_EQ(taken.size(), 1u) << "it is reported once";
}

TEST(Inbox, KeepsEveryObservationOfTheGraph) {
  Inbox inbox;
  for (std::size_t i = 0; i < Inbox::kMaxWaiting + 10; ++i) inbox.put(NodeVanished{"/n"});
  std::vector<Observation> taken;
  inbox.take(kNever, taken);
  EXPECT_EQ(taken.size(), Inbox::kMaxWaiting + 10);
}

}  // namespace
}  // namespace culprit
