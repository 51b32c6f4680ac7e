#include <cmath>
#include <deque>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "monitor/phi_accrual.h"
#include "monitor/sliding_count.h"
#include "monitor/sliding_values.h"

namespace culprit::monitor {
namespace {

using namespace std::chrono_literals;

Time at(Duration d) { return Time(d); }

RC_GTEST_PROP(SlidingCount, CountsExactlyWhatIsInTheWindow, ()) {
  const Duration window(*rc::gen::inRange(1, 50));
  SlidingCount count(window);
  std::vector<std::pair<Time, std::uint32_t>> all;
  Time now{};
  const int steps = *rc::gen::inRange(0, 100);
  for (int i = 0; i < steps; ++i) {
    now += Duration(*rc::gen::inRange(0, 20));
    if (*rc::gen::arbitrary<bool>()) {
      const auto n = *rc::gen::inRange<std::uint32_t>(1, 4);
      count.add(now, n);
      all.push_back({now, n});
    } else {
      count.advance(now);
    }
    const auto inside = [&](Time t) {
      std::uint64_t sum = 0;
      for (const auto& [when, n] : all) sum += when + window > t ? n : 0;
      return sum;
    };
    RC_ASSERT(count.count() == inside(now));
    const auto wanted = *rc::gen::inRange<std::uint64_t>(1, 10);
    const Time falls = count.falls_below(wanted);
    if (inside(now) < wanted) {
      RC_ASSERT(falls == kNever);
    } else {
      RC_ASSERT(inside(falls) < wanted);
      RC_ASSERT(inside(falls - Duration(1)) >= wanted);
    }
  }
}

TEST(SlidingCount, StaysExactWhenAFloodComes) {
  SlidingCount count(1s);
  for (int i = 0; i < 100000; ++i) count.add(at(Duration(i * 1000)), 1);
  EXPECT_EQ(count.count(), 100000u);
  count.advance(at(10s));
  EXPECT_EQ(count.count(), 0u);
}

TEST(SlidingValues, SummarisesTheWindow) {
  SlidingValues values(3s);
  EXPECT_FALSE(values.summary());
  values.add(at(0s), 100);
  for (int i = 1; i <= 3; ++i) values.add(at(std::chrono::seconds(i)), i);
  const auto summary = values.summary();
  EXPECT_DOUBLE_EQ(summary->mean, 2);
  EXPECT_DOUBLE_EQ(summary->min, 1);
  EXPECT_DOUBLE_EQ(summary->max, 3);
  EXPECT_DOUBLE_EQ(summary->stddev, std::sqrt(2.0 / 3));
  EXPECT_EQ(values.next_change(), at(4s));
  values.advance(at(10s));
  EXPECT_FALSE(values.summary());
}

PhiAccrual beating(Duration period, int beats) {
  PhiAccrual phi;
  for (int i = 0; i < beats; ++i) phi.add(at(period * i), 1);
  return phi;
}

TEST(PhiAccrual, IsUnknownUntilThereIsARhythm) {
  EXPECT_FALSE(beating(100ms, 5).phi(at(1s)));
  EXPECT_TRUE(beating(100ms, 6).phi(at(1s)));
}

TEST(PhiAccrual, GrowsWithSilenceInTheRhythmOfTheTopic) {
  const PhiAccrual fast = beating(100ms, 50);
  const Time last = at(100ms * 49);
  EXPECT_LT(*fast.phi(last + 100ms), 1);
  EXPECT_GT(*fast.phi(last + 300ms), 8);
  const PhiAccrual slow = beating(1s, 50);
  EXPECT_LT(*slow.phi(at(49s) + 1s), 1);
  EXPECT_GT(*slow.phi(at(49s) + 3s), 8);
  EXPECT_TRUE(std::isfinite(*fast.phi(last + 24h)));
}

TEST(PhiAccrual, TellsWhenAThresholdWillBeExceeded) {
  const PhiAccrual phi = beating(100ms, 50);
  for (const double threshold : {0.5, 1.0, 3.0, 8.0, 16.0, 50.0}) {
    const Time crossing = phi.exceeds(PhiAccrual::deviations(threshold));
    EXPECT_GT(*phi.phi(crossing + 1us), threshold);
    EXPECT_LT(*phi.phi(crossing - 1us), threshold);
  }
}

TEST(PhiAccrual, DoesNotLearnAnOutageAsRhythm) {
  PhiAccrual phi = beating(100ms, 50);
  phi.add(at(20s), 1);
  EXPECT_GT(*phi.phi(at(20s) + 300ms), 8);
}

TEST(PhiAccrual, LearnsANewRhythmWhenItLasts) {
  PhiAccrual phi = beating(100ms, 50);
  for (int i = 0; i < 20; ++i) phi.add(at(10s + 1s * i), 1);
  EXPECT_LT(*phi.phi(at(29s) + 1s), 1);
}

TEST(PhiAccrual, SpreadsMessagesThatWereLostOnTheWay) {
  PhiAccrual phi;
  for (int i = 0; i < 50; ++i) phi.add(at(300ms * i), 3);
  EXPECT_GT(*phi.phi(at(300ms * 49) + 300ms), 8) << "the topic beats every 100 ms";
}

}  // namespace
}  // namespace culprit::monitor
