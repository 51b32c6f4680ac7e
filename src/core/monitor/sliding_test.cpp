#include <cmath>
#include <deque>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "monitor/phi_accrual.h"
#include "monitor/sliding_count.h"
#include "monitor/value_window.h"

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
      RC_ASSERT(count.add(now, n));
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
  for (int i = 0; i < 100000; ++i) EXPECT_TRUE(count.add(at(Duration(i * 1000)), 1));
  EXPECT_EQ(count.count(), 100000u);
  count.advance(at(10s));
  EXPECT_EQ(count.count(), 0u);
}

// As of a topic of 1 kHz over a minute.
TEST(SlidingCount, IsConstantForAConstantRateHoweverLongTheWindow) {
  SlidingCount count(60s);
  for (int i = 0; i < 200000; ++i) {
    EXPECT_TRUE(count.add(at(1ms * i), 1));
    if (i < 60000) continue;
    ASSERT_EQ(count.rate(), 1000) << i;
  }
}

TEST(SlidingCount, BeginsAnewWhereItCannotHoldAllArrivals) {
  SlidingCount count(1s, 3);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(count.add(at(1ms * i), 2));
  EXPECT_TRUE(count.add(at(2ms), 1)) << "at the same time as the last ones";
  EXPECT_EQ(count.count(), 7u);
  EXPECT_FALSE(count.add(at(3ms), 2));
  EXPECT_EQ(count.count(), 2u);
  EXPECT_TRUE(count.add(at(2s), 1));
  EXPECT_EQ(count.count(), 1u);
}

using Of = ValueWindow::Of;

// A window as its definition has it, computed anew from all samples each time.
struct NaiveWindow {
  Of of;
  Duration window;
  Duration longest_pause;
  std::vector<std::pair<Time, double>> samples{};

  std::optional<double> value(Time now) const {
    if (samples.empty() || now - samples.back().first >= longest_pause) return std::nullopt;
    std::size_t first = samples.size() - 1;
    while (first > 0 && samples[first].first - samples[first - 1].first <= longest_pause) --first;
    if (samples[first].first + window > now) return std::nullopt;
    std::vector<double> inside;
    for (const auto& [when, value] : samples) {
      if (when + window > now) inside.push_back(value);
    }
    return inside.empty() ? std::nullopt : std::optional(of_all(inside));
  }
  double of_all(const std::vector<double>& values) const {
    if (of == Of::kMin) return *std::ranges::min_element(values);
    if (of == Of::kMax) return *std::ranges::max_element(values);
    long double mean = 0;
    for (const double v : values) mean += v;
    mean /= static_cast<long double>(values.size());
    if (of == Of::kMean) return static_cast<double>(mean);
    long double squares = 0;
    for (const double v : values) squares += (v - mean) * (v - mean);
    return static_cast<double>(std::sqrt(squares / static_cast<long double>(values.size())));
  }
};

bool is_nearly(const std::optional<double>& a, const std::optional<double>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return std::fabs(*a - *b) <= 1e-12 * (1 + std::fabs(*b));
}

// Any window, any rate, any pauses: known exactly when it is covered, and what it is then.
RC_GTEST_PROP(ValueWindow, IsWhatItsDefinitionSays, ()) {
  const auto of = *rc::gen::element(Of::kMean, Of::kMin, Of::kMax, Of::kStddev);
  const Duration length(*rc::gen::inRange(1, 60));
  const Duration pause(*rc::gen::inRange(1, 90));
  ValueWindow window(of, length, pause);
  NaiveWindow naive{of, length, pause};
  const int usual = *rc::gen::inRange(1, 20);
  Time now{};
  for (int i = *rc::gen::inRange(0, 200); i > 0; --i) {
    const bool is_pause = *rc::gen::inRange(0, 15) == 0;
    const Time next = now + Duration(*rc::gen::inRange(0, is_pause ? 150 : usual));
    Time changes = kLongAgo;
    auto held = window.value(now);
    for (; now < next; now += Duration(1)) {
      if (changes == kLongAgo || changes <= now) {
        held = window.value(now);
        changes = window.next_change(now);
        RC_ASSERT(changes > now);
      }
      RC_ASSERT(is_nearly(held, naive.value(now)));
    }
    const double value = *rc::gen::element(-1.0, 0.0, 0.25, 0.1, 3.0, 1e6);
    RC_ASSERT(window.add(now, value));
    naive.samples.emplace_back(now, value);
    RC_ASSERT(is_nearly(window.value(now), naive.value(now)));
  }
}

// Long ones are summed up by blocks.
RC_GTEST_PROP(ValueWindow, IsWhatItsDefinitionSaysAlsoOfThousandsOfSamples, ()) {
  const auto of = *rc::gen::element(Of::kMean, Of::kMin, Of::kMax, Of::kStddev);
  const Duration length(*rc::gen::inRange(1, 9000));
  ValueWindow window(of, length, 1s);
  NaiveWindow naive{of, length, 1s};
  Time now{};
  for (int looks = *rc::gen::inRange(0, 12); looks > 0; --looks) {
    const std::uint32_t step = *rc::gen::inRange(1, 4);
    std::uint32_t random = *rc::gen::inRange(0, 1000000);
    for (int i = *rc::gen::inRange(0, 3000); i > 0; --i) {
      now += Duration(random % 7 == 0 ? 0 : step);
      random = random * 1664525u + 1013904223u;
      const double value = (random >> 16) * (looks % 2 == 0 ? 1e-3 : 10) - 5;
      RC_ASSERT(window.add(now, value));
      naive.samples.emplace_back(now, value);
    }
    now += Duration(*rc::gen::inRange(0, 2000));
    RC_ASSERT(is_nearly(window.value(now), naive.value(now)));
  }
}

RC_GTEST_PROP(LongQueue, IsAQueue, ()) {
  LongQueue<int> queue(1000);
  std::deque<int> model;
  for (int i = *rc::gen::inRange(0, 60); i > 0; --i) {
    const int count = *rc::gen::inRange(0, 100);
    switch (*rc::gen::inRange(0, 5)) {
      case 0:
      case 1:
        for (int n = 0; n < count && !queue.full(); ++n) {
          queue.push_back(n);
          model.push_back(n);
        }
        break;
      case 2:
      case 3:
        for (int n = 0; n < count && !queue.empty(); ++n) {
          queue.pop_front();
          model.pop_front();
        }
        break;
      default:
        model.resize(std::min<std::size_t>(model.size(), static_cast<std::size_t>(count)));
        queue.truncate(model.size());
    }
    RC_ASSERT(queue.size() == model.size());
    for (std::size_t n = 0; n < model.size(); ++n) RC_ASSERT(queue[n] == model[n]);
  }
}

ValueWindow filled(Of of, Duration length, Duration period, int count, double (*value)(int)) {
  ValueWindow window(of, length, 1s);
  for (int i = 0; i < count; ++i) EXPECT_TRUE(window.add(at(period * i), value(i)));
  return window;
}

// A window for which 4,096 values were too few.
TEST(ValueWindow, SeesAllOfALongWindowOfAFastSignal) {
  const auto step = [](int i) { return i < 600 ? 0.0 : 1.0; };
  const auto after = [&](Of of, Duration time) {
    return filled(of, 25s, 5ms, static_cast<int>(time / 5ms) + 1, step).value(at(time));
  };
  EXPECT_FALSE(after(Of::kMean, 24995ms));
  EXPECT_EQ(after(Of::kMean, 25s), 22 / 25.0 + 1 / 5000.0)
      << "without that at 0 s, with that at 3 s";
  EXPECT_EQ(after(Of::kMin, 27990ms), 0);
  EXPECT_EQ(after(Of::kMin, 28s), 1);
  EXPECT_EQ(after(Of::kMax, 25s), 1);
}

TEST(ValueWindow, TheDeviationOfEqualValuesIsZeroAndTheirMeanIsTheirValue) {
  for (const double value : {0.1, -1e-300, 1e300, 0.30000000000000004, 12345.678}) {
    ValueWindow deviation(Of::kStddev, 1s, 1s);
    ValueWindow mean(Of::kMean, 1s, 1s);
    for (int i = 0; i < 5000; ++i) {
      EXPECT_TRUE(deviation.add(at(1ms * i), i == 500 ? 7 : value));
      EXPECT_TRUE(mean.add(at(1ms * i), i == 500 ? 7 : value));
    }
    EXPECT_EQ(deviation.value(at(5s)), 0) << value;
    EXPECT_EQ(mean.value(at(5s)), value);
  }
}

// Sums of squares would leave nothing of it, and what a large value rounds away stays away.
TEST(ValueWindow, IsNotSpoiledByLargeValues) {
  const auto swinging = [](int i) { return i == 10 ? 1e15 : 1e9 + (i % 2 == 0 ? 0.5 : -0.5); };
  EXPECT_NEAR(*filled(Of::kStddev, 1s, 1ms, 3000, swinging).value(at(2999ms)), 0.5, 1e-9);
  EXPECT_DOUBLE_EQ(*filled(Of::kMean, 1s, 1ms, 3000, swinging).value(at(2999ms)), 1e9);
}

TEST(ValueWindow, AnInfiniteValueLeavesWithItsSample) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto once_infinite = [](int i) { return i == 1500 ? kInfinity : 2.0; };
  for (const Of of : {Of::kMean, Of::kMax})
    EXPECT_EQ(filled(of, 1s, 1ms, 2001, once_infinite).value(at(2s)), kInfinity);
  EXPECT_TRUE(std::isnan(*filled(Of::kStddev, 1s, 1ms, 2001, once_infinite).value(at(2s))));
  for (const Of of : {Of::kMean, Of::kMax, Of::kMin})
    EXPECT_EQ(filled(of, 1s, 1ms, 2501, once_infinite).value(at(2500ms)), 2);
  EXPECT_EQ(filled(Of::kStddev, 1s, 1ms, 2501, once_infinite).value(at(2500ms)), 0);
}

TEST(ValueWindow, IsUnknownWhereItCannotHoldAllSamples) {
  for (const Of of : {Of::kMean, Of::kMin, Of::kStddev}) {
    ValueWindow window(of, 100ms, 1s, 50);
    int failed = 0;
    for (int i = 0; i <= 200; ++i) failed += window.add(at(1ms * i), i) ? 0 : 1;
    EXPECT_EQ(failed, 4);
    EXPECT_FALSE(window.value(at(200ms))) << "too many for it";
    for (int i = 1; i <= 20; ++i) EXPECT_TRUE(window.add(at(200ms + 10ms * i), 5));
    EXPECT_EQ(window.value(at(400ms)), of == Of::kStddev ? 0 : 5) << "they fit again";
  }
}

// Only what can still become the least is kept.
TEST(ValueWindow, AnExtremeNeedsNoPlaceForWhatItOutdoes) {
  ValueWindow window(Of::kMin, 10s, 1s, 100);
  for (int i = 0; i < 20000; ++i) EXPECT_TRUE(window.add(at(1ms * i), i % 100));
  EXPECT_EQ(window.value(at(20s)), 0);
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
