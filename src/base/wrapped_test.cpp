#include "base/wrapped.h"

#include <gtest/gtest.h>

namespace culprit {
namespace {

TEST(Wrapped, HasLinesThatFit) {
  EXPECT_EQ(wrapped("one two three", 7), "one two\nthree");
  EXPECT_EQ(wrapped("a line\nand another", 80), "a line\nand another");
  EXPECT_EQ(wrapped("a-word-that-is-too-long", 5), "a-word-that-is-too-long");
  EXPECT_EQ(wrapped("", 5), "");
}

}  // namespace
}  // namespace culprit
