#include "robot/unreadable.h"

#include <gtest/gtest.h>

namespace culprit {
namespace {

TEST(Unreadable, IsATextThatIsTooLong) {
  EXPECT_EQ(readable(Value("open")), Value("open"));
  EXPECT_EQ(readable(Value(0.5)), Value(0.5));
  const std::string longest(kLongestText, 'x');
  EXPECT_EQ(readable(Value(longest)), Value(longest));
  EXPECT_TRUE(is_unreadable(readable(Value(longest + "x"))));
}

}  // namespace
}  // namespace culprit
