#include "alerts/outbox.h"

#include <gtest/gtest.h>

namespace culprit::alerts {
namespace {

using namespace std::chrono_literals;

Alert alert(const std::string& id, Alert::State state = Alert::State::kFiring,
            bool needs_person = false) {
  Alert alert;
  alert.id = id;
  alert.state = state;
  alert.needs_person = needs_person;
  return alert;
}

// The alerts that are sent, one after the other, if the destination accepts everything.
std::string sent_by(Outbox& outbox, Time now) {
  std::string ids;
  while (const auto next = outbox.next(now)) {
    ids +=
        (ids.empty() ? "" : " ") + next->id + (next->state == Alert::State::kResolved ? "-" : "");
    outbox.sent(now);
  }
  return ids;
}

TEST(Outbox, SendsTheNewestOfEachFaultAndThoseThatNeedAPersonFirst) {
  Outbox outbox({});
  outbox.put(alert("a"), Time());
  outbox.put(alert("b"), Time());
  outbox.put(alert("c", Alert::State::kFiring, true), Time());
  outbox.put(alert("a", Alert::State::kResolved), Time());
  EXPECT_EQ(sent_by(outbox, Time()), "c a- b");
  EXPECT_EQ(outbox.due(), kNever);
}

TEST(Outbox, TriesAgainEachTimeLaterWithWhatIsNewestThen) {
  Outbox outbox({});
  Time now{};
  outbox.put(alert("a"), now);
  for (const Duration wait : {1s, 2s, 4s, 8s}) {
    ASSERT_TRUE(outbox.next(now));
    outbox.failed(now, false);
    EXPECT_EQ(outbox.due(), now + wait);
    EXPECT_FALSE(outbox.next(now + wait - 1ms));
    now += wait;
  }
  outbox.put(alert("a", Alert::State::kResolved), now);
  EXPECT_EQ(sent_by(outbox, now), "a-") << "the resolved alert also shows that it fired";
  for (int i = 0; i < 100; ++i) {
    outbox.put(alert("b"), now);
    ASSERT_TRUE(outbox.next(now));
    outbox.failed(now, false);
    EXPECT_LE(outbox.due() - now, 5min);
    now = outbox.due();
  }
}

TEST(Outbox, GivesUpWhatIsRefusedAndTellsHowMany) {
  Outbox outbox({});
  outbox.put(alert("a"), Time());
  ASSERT_TRUE(outbox.next(Time()));
  outbox.failed(Time(), true);
  EXPECT_FALSE(outbox.next(Time()));
  EXPECT_EQ(outbox.take_given_up(), 1u);
  EXPECT_EQ(outbox.take_given_up(), 0u);
  outbox.put(alert("b"), Time());
  EXPECT_EQ(outbox.next(Time())->untold, 1u) << "the next one shows that there were more";
  outbox.sent(Time());
  outbox.put(alert("c"), Time());
  EXPECT_EQ(outbox.next(Time())->untold, 0u);
}

TEST(Outbox, KeepsNotMoreThanItsLimitAndThoseThatNeedAPersonLongest) {
  Outbox outbox({.kept = 3});
  outbox.put(alert("needed", Alert::State::kFiring, true), Time());
  for (int i = 0; i < 1000; ++i) outbox.put(alert(std::to_string(i)), Time());
  EXPECT_EQ(outbox.waiting(), 3u);
  EXPECT_EQ(outbox.take_given_up(), 998u);
  EXPECT_EQ(sent_by(outbox, Time()), "needed 998 999");
}

TEST(Outbox, SendsNotTooManyInATime) {
  Outbox outbox({.kept = 100, .burst = 3, .refill = 30s});
  for (int i = 0; i < 10; ++i) outbox.put(alert(std::to_string(i)), Time());
  EXPECT_EQ(sent_by(outbox, Time()), "0 1 2");
  EXPECT_EQ(outbox.due(), Time() + 30s);
  EXPECT_EQ(sent_by(outbox, Time() + 29s), "");
  EXPECT_EQ(sent_by(outbox, Time() + 30s), "3");
  EXPECT_EQ(sent_by(outbox, Time() + 10min), "4 5 6") << "what was not used up does not add up";
}

TEST(Outbox, RepeatsWhatIsNotOverWhereThatIsWanted) {
  Outbox outbox({.repeat = 1min});
  outbox.put(alert("a"), Time());
  EXPECT_EQ(sent_by(outbox, Time()), "a");
  EXPECT_EQ(outbox.due(), Time() + 1min);
  EXPECT_EQ(sent_by(outbox, Time() + 1min), "a");
  ASSERT_TRUE(outbox.next(Time() + 2min));
  outbox.failed(Time() + 2min, false);
  EXPECT_EQ(sent_by(outbox, Time() + 2min + 1s), "a");
  outbox.put(alert("a", Alert::State::kResolved), Time() + 2min + 2s);
  EXPECT_EQ(sent_by(outbox, Time() + 2min + 2s), "a-");
  EXPECT_EQ(outbox.due(), kNever);
}

TEST(Outbox, DoesNotRepeatWhatWasResolvedWhileItWasSent) {
  Outbox outbox({.repeat = 1min});
  outbox.put(alert("a"), Time());
  ASSERT_TRUE(outbox.next(Time()));
  outbox.put(alert("a", Alert::State::kResolved), Time());
  outbox.sent(Time());
  EXPECT_EQ(sent_by(outbox, Time()), "a-");
  EXPECT_EQ(outbox.due(), kNever);
}

}  // namespace
}  // namespace culprit::alerts
