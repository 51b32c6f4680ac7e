#include "study/ordered_work.h"

#include <atomic>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit::study {
namespace {

RC_GTEST_PROP(OrderedWork, GivesEachResultOnceAndInOrder, ()) {
  const auto first = *rc::gen::inRange<std::uint64_t>(0, 50);
  const auto count = *rc::gen::inRange<std::uint64_t>(0, 200);
  const auto jobs = *rc::gen::inRange<unsigned>(1, 9);
  std::vector<std::uint64_t> got;
  work_in_order(
      first, first + count, jobs, [](std::uint64_t i) { return i * i; },
      [&](std::uint64_t i, std::uint64_t square) {
        RC_ASSERT(square == i * i);
        got.push_back(i);
        return true;
      });
  RC_ASSERT(got.size() == count);
  for (std::uint64_t i = 0; i < count; ++i) RC_ASSERT(got[i] == first + i);
}

TEST(OrderedWork, EndsWhenNothingMoreIsWanted) {
  std::atomic<std::uint64_t> begun = 0;
  std::uint64_t last = 0;
  work_in_order(
      0, 1'000'000, 3,
      [&](std::uint64_t i) {
        ++begun;
        return i;
      },
      [&](std::uint64_t i, std::uint64_t) {
        last = i;
        return i < 9;
      });
  EXPECT_EQ(last, 9);
  EXPECT_LE(begun, 10 + 3 * 4 + 3);
}

}  // namespace
}  // namespace culprit::study
