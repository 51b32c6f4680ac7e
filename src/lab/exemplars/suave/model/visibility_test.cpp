#include "exemplars/suave/model/visibility.h"

#include <algorithm>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::suave::model {
namespace {

const char* best_mode(std::int64_t second) {
  const auto found = std::find_if(
      kSearchModes.begin(), kSearchModes.end(),
      [&](const SearchMode& mode) { return mode.visibility <= water_visibility(second); });
  return found == kSearchModes.end() ? nullptr : found->name;
}

TEST(Visibility, ChangesItsBandWhenTheExemplarsDoes) {
  std::vector<std::int64_t> changes;
  for (std::int64_t second = 1; second < 160; ++second) {
    ASSERT_NE(best_mode(second), nullptr) << second;
    if (best_mode(second) != best_mode(second - 1)) changes.push_back(second);
  }
  EXPECT_THAT(changes, testing::ElementsAre(12, 23, 58, 69, 92, 103, 138, 149));
}

TEST(Visibility, IsNeverTooLowForTheLowestSearch) {
  EXPECT_EQ(water_visibility(0), 3.75);
  EXPECT_EQ(water_visibility(40), 1.25);
  EXPECT_EQ(water_visibility(120), 1.25);
}

}  // namespace
}  // namespace culprit::suave::model
