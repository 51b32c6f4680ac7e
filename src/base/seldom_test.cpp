#include "base/seldom.h"

#include <string>

#include <gtest/gtest.h>

namespace culprit {
namespace {

TEST(Seldom, HasNothingAtFirstAndTakesAPointersRoom) {
  const Seldom<std::string> nothing;
  EXPECT_FALSE(nothing);
  EXPECT_FALSE(nothing.has_value());
  EXPECT_EQ(nothing.value_or("else"), "else");
  EXPECT_EQ(sizeof nothing, sizeof(void*));
}

TEST(Seldom, TakesWhatAnOptionalHas) {
  EXPECT_FALSE(Seldom<std::string>(std::optional<std::string>()));
  const Seldom<std::string> host(std::optional<std::string>("rover"));
  ASSERT_TRUE(host);
  EXPECT_EQ(*host, "rover");
  EXPECT_EQ(host->size(), 5u);
  EXPECT_EQ(host.value_or("else"), "rover");
}

TEST(Seldom, IsAValue) {
  Seldom<std::string> host = std::string("rover");
  Seldom<std::string> copy = host;
  EXPECT_EQ(copy, host);
  *copy = "drone";
  EXPECT_EQ(*host, "rover");
  EXPECT_FALSE(copy == host);
  host = copy;
  EXPECT_EQ(*host, "drone");
  host = std::nullopt;
  EXPECT_FALSE(host);
  EXPECT_FALSE(copy == host);
  EXPECT_EQ(host, Seldom<std::string>());
}

}  // namespace
}  // namespace culprit
