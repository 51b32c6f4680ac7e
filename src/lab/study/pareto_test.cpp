#include "study/pareto.h"

#include <gtest/gtest.h>

namespace culprit::study {
namespace {

using Front = std::vector<bool>;

TEST(ParetoFront, HasWhatNothingElseBeats) {
  EXPECT_EQ(pareto_front({{1, 3}, {2, 2}, {3, 3}, {3, 1}, {2, 3}}),
            (Front{true, true, false, true, false}));
}

TEST(ParetoFront, HasAllThatAreEqual) {
  EXPECT_EQ(pareto_front({{1, 2}, {1, 2}, {1, 3}}), (Front{true, true, false}));
}

TEST(ParetoFront, IsEmptyOfNothing) { EXPECT_EQ(pareto_front({}), Front{}); }

}  // namespace
}  // namespace culprit::study
