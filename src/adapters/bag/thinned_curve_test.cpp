// Few points stand for very many samples.
#include "bag/thinned_curve.h"

#include <algorithm>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit::bag {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr std::int64_t kMillisecond = 1'000'000;
constexpr std::int64_t kYear2100 = 4'102'444'800'000'000'000;
using Points = std::vector<ThinnedCurve::Point>;

TEST(ThinnedCurve, IsAsGivenWhileThereIsRoom) {
  ThinnedCurve curve;
  for (int i = 0; i < 3; ++i) curve.add(i * 100 * kMillisecond, 10 + i);
  EXPECT_EQ(curve.points(), (Points{{0, 10}, {100 * kMillisecond, 11}, {200 * kMillisecond, 12}}));
  EXPECT_THAT(ThinnedCurve().points(), IsEmpty());
}

TEST(ThinnedCurve, KeepsASpikeOfOneSampleAmongAMillion) {
  ThinnedCurve curve;
  for (std::int64_t i = 0; i < 1'000'000; ++i)
    curve.add(i * kMillisecond, i == 654'321 ? 99 : i == 654'322 ? -99 : 1);
  const Points points = curve.points();
  EXPECT_LE(points.size(), 2 * ThinnedCurve::kMostBuckets);
  EXPECT_GE(points.size(), ThinnedCurve::kMostBuckets / 2);
  EXPECT_THAT(points, testing::Contains(ThinnedCurve::Point{654'321 * kMillisecond, 99}));
  EXPECT_THAT(points, testing::Contains(ThinnedCurve::Point{654'322 * kMillisecond, -99}));
  EXPECT_EQ(curve.lowest(), -99);
  EXPECT_EQ(curve.highest(), 99);
}

TEST(ThinnedCurve, LeavesOutWhatIsNoNumberToDraw) {
  ThinnedCurve curve;
  for (const double value :
       {std::nan(""), std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::max()})
    curve.add(0, value);
  EXPECT_EQ(curve.samples(), 0u);
  curve.add(1, 2.5);
  EXPECT_THAT(curve.points(), ElementsAre(ThinnedCurve::Point{1, 2.5}));
}

TEST(ThinnedCurve, CallsAPauseWhatIsLongerThanItsRhythm) {
  ThinnedCurve curve;
  for (int i = 0; i < 100; ++i) curve.add(i * 100 * kMillisecond, i);
  EXPECT_GT(curve.longest_gap(), 200 * kMillisecond);
  EXPECT_LT(curve.longest_gap(), 1000 * kMillisecond);
}

RC_GTEST_PROP(ThinnedCurve, IsBoundedAndInOrderWhateverComes, ()) {
  ThinnedCurve curve;
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  const auto count = *rc::gen::inRange<std::size_t>(1, 3 * ThinnedCurve::kMostBuckets);
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = *rc::gen::inRange<std::int64_t>(0, kYear2100);
    const double value = *rc::gen::inRange(-1000, 1000);
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
    curve.add(at, value);
  }
  const Points points = curve.points();
  RC_ASSERT(points.size() <= 2 * ThinnedCurve::kMostBuckets);
  RC_ASSERT(std::ranges::is_sorted(points, {}, &ThinnedCurve::Point::at));
  RC_ASSERT(std::ranges::min(points, {}, &ThinnedCurve::Point::value).value == lowest);
  RC_ASSERT(std::ranges::max(points, {}, &ThinnedCurve::Point::value).value == highest);
  RC_ASSERT(curve.longest_gap() >= 0);
}

}  // namespace
}  // namespace culprit::bag
