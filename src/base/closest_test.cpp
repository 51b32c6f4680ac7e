#include "base/closest.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit {
namespace {

// The distance by its definition: slow, and plainly right.
std::size_t distance(std::string_view a, std::string_view b) {
  if (a.empty() || b.empty()) return std::max(a.size(), b.size());
  const auto a_rest = a.substr(1);
  const auto b_rest = b.substr(1);
  std::size_t least = std::min({distance(a_rest, b_rest) + (a[0] == b[0] ? 0 : 1),
                                distance(a_rest, b) + 1, distance(a, b_rest) + 1});
  const bool is_swapped = a.size() > 1 && b.size() > 1 && a[0] == b[1] && a[1] == b[0];
  if (is_swapped) least = std::min(least, distance(a.substr(2), b.substr(2)) + 1);
  return least;
}

std::string word() {
  const auto letters = rc::gen::container<std::string>(rc::gen::element('a', 'b', 'c', '_'));
  return *rc::gen::resize(7, letters);
}

RC_GTEST_PROP(Closest, IsTheFirstOfTheNearestThatAreNear, ()) {
  const std::string name = word();
  std::vector<std::string> known;
  for (int n = *rc::gen::inRange(0, 6); n > 0; --n) known.push_back(word());
  std::string expected;
  std::size_t best = 1000;
  for (const std::string& candidate : known) {
    const std::size_t d = distance(name, candidate);
    const bool is_near = d > 0 && 3 * d <= std::max(name.size(), candidate.size());
    if (!is_near || d >= best) continue;
    expected = candidate;
    best = d;
  }
  RC_ASSERT(closest(name, {known.begin(), known.end()}) == expected);
}

TEST(Closest, SeesOneSlipOfTheFingers) {
  const std::vector<std::string_view> known = {"camera_front", "camera_back", "lidar"};
  EXPECT_EQ(closest("camera_frnot", known), "camera_front");
  EXPECT_EQ(closest("camera_bac", known), "camera_back");
  EXPECT_EQ(closest("sonar", known), "");
}

}  // namespace
}  // namespace culprit
