#include "base/duration_words.h"

#include <gtest/gtest.h>

namespace culprit {
namespace {

using namespace std::chrono_literals;

TEST(DurationWords, AreInTheUnitThatPeopleWouldTake) {
  EXPECT_EQ(in_words(20001193534ns), "20.0 s");
  EXPECT_EQ(in_words(2500ms), "2.5 s");
  EXPECT_EQ(in_words(850400us), "850 ms");
  EXPECT_EQ(in_words(12us), "12 us");
  EXPECT_EQ(in_words(200s), "3 min 20 s");
  EXPECT_EQ(in_words(1h), "1 h");
  EXPECT_EQ(in_words(125min), "2 h 5 min");
  EXPECT_EQ(in_words(76h), "3 days 4 h");
  EXPECT_EQ(in_words(0s), "0 s");
  EXPECT_EQ(in_words(-3s), "-3.0 s");
}

TEST(DurationWords, HoldForEveryDuration) {
  EXPECT_FALSE(in_words(Duration::max()).empty());
  EXPECT_FALSE(in_words(Duration::min()).empty());
}

}  // namespace
}  // namespace culprit
