#include "base/joined.h"

#include <vector>

#include <gtest/gtest.h>

namespace culprit {
namespace {

TEST(Joined, PutsTextsInARow) {
  const std::vector<std::string> names = {"camera", "lidar"};
  EXPECT_EQ(joined(names), "camera, lidar");
  EXPECT_EQ(joined(names, "; "), "camera; lidar");
  EXPECT_EQ(joined(std::vector<std::string_view>()), "");
}

TEST(Joined, TakesTheTextOfEach) {
  struct Part {
    std::string name;
  };
  const std::vector<Part> parts = {{"left"}, {"right"}};
  EXPECT_EQ(joined(parts, ", ", &Part::name), "left, right");
  const auto as_text = [](int number) { return std::to_string(number); };
  EXPECT_EQ(joined(std::vector{1, 2}, "+", as_text), "1+2");
}

}  // namespace
}  // namespace culprit
