#include "base/amount.h"

#include <gtest/gtest.h>

namespace culprit {
namespace {

TEST(Amount, CountsInWords) {
  EXPECT_EQ(amount_of(0, "rule"), "0 rules");
  EXPECT_EQ(amount_of(1, "rule"), "1 rule");
  EXPECT_EQ(amount_of(2, "rule"), "2 rules");
  EXPECT_EQ(amount_of(1, "strategy", "strategies"), "1 strategy");
  EXPECT_EQ(amount_of(2, "strategy", "strategies"), "2 strategies");
}

}  // namespace
}  // namespace culprit
