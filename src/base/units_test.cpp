#include "base/units.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit {
namespace {

using namespace std::chrono_literals;

TEST(Duration, IsReadWithItsUnit) {
  EXPECT_EQ(*parse_duration("200ms"), 200ms);
  EXPECT_EQ(*parse_duration("1.5s"), 1500ms);
  EXPECT_EQ(*parse_duration("0.5min"), 30s);
  EXPECT_EQ(*parse_duration("2h"), 2h);
  EXPECT_EQ(*parse_duration("3us"), 3us);
  EXPECT_EQ(*parse_duration("7ns"), 7ns);
}

TEST(Duration, WithoutUnitIsRefused) {
  for (const char* text : {"", "5", "ms", "5 ms", "5sec", "1e400s", "nan s", "infs"}) {
    EXPECT_FALSE(parse_duration(text)) << text;
  }
}

TEST(Duration, SaturatesInsteadOfOverflowing) {
  EXPECT_EQ(from_seconds(1e300), Duration::max());
  EXPECT_EQ(from_seconds(-1e300), Duration::min());
  EXPECT_EQ(from_seconds(std::numeric_limits<double>::quiet_NaN()), Duration::zero());
}

// Up to 2^53 ns (104 days) the number in the text is exact.
RC_GTEST_PROP(Duration, IsReadBackAsWritten, ()) {
  const Duration d(*rc::gen::inRange<std::int64_t>(0, std::int64_t{1} << 53));
  RC_ASSERT(*parse_duration(to_string(d)) == d);
}

}  // namespace
}  // namespace culprit
