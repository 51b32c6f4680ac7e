#include "base/invariant.h"

#include <gtest/gtest.h>

namespace culprit {
namespace {

TEST(InvariantDeathTest, StopsTheProgramAndNamesConditionAndPlace) {
  const int restarts = 4;
  EXPECT_DEATH(CULPRIT_ASSERT(restarts <= 3), "invariant_test.cpp:.*'restarts <= 3' does not hold");
}

TEST(Invariant, ThatHoldsIsEvaluatedOnceAndChangesNothing) {
  int evaluated = 0;
  CULPRIT_ASSERT(++evaluated == 1);
  EXPECT_EQ(evaluated, 1);
}

}  // namespace
}  // namespace culprit
