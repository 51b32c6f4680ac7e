#include "simulation/agenda.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit::simulation {
namespace {

TEST(Agenda, HasNothingNextWhenEmpty) { EXPECT_EQ(Agenda().next(), kNever); }

RC_GTEST_PROP(Agenda, GoesByTimeAndThenByOrderOfAdding, (const std::vector<std::uint8_t>& due)) {
  Agenda agenda;
  std::vector<std::size_t> done;
  for (std::size_t i = 0; i < due.size(); ++i)
    agenda.add(Time{Duration(due[i])}, [&done, i] { done.push_back(i); });
  while (agenda.next() != kNever) agenda.take()();

  std::vector<std::size_t> expected(due.size());
  for (std::size_t i = 0; i < due.size(); ++i) expected[i] = i;
  std::stable_sort(expected.begin(), expected.end(),
                   [&](std::size_t a, std::size_t b) { return due[a] < due[b]; });
  RC_ASSERT(done == expected);
}

}  // namespace
}  // namespace culprit::simulation
