#include "base/value.h"

#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit {
namespace {

TEST(ValueFromText, ReadsDiagnosticsAsTheirPublishersMeantThem) {
  EXPECT_EQ(value_from_text("True"), Value(true));
  EXPECT_EQ(value_from_text(" false "), Value(false));
  EXPECT_EQ(value_from_text("42"), Value(std::int64_t{42}));
  EXPECT_EQ(value_from_text("+7"), Value(std::int64_t{7}));
  EXPECT_EQ(value_from_text("-0.5"), Value(-0.5));
  EXPECT_EQ(value_from_text("1e-7"), Value(1e-7));
  EXPECT_EQ(value_from_text("RECOVERED"), Value(std::string("RECOVERED")));
  EXPECT_EQ(value_from_text("12 V"), Value(std::string("12 V")));
  EXPECT_EQ(value_from_text(""), Value(std::string()));
}

TEST(ValueFromText, TakesWholeNumbersThatDoNotFitAsNumbers) {
  EXPECT_EQ(value_from_text("9223372036854775808"), Value(9223372036854775808.0));
}

RC_GTEST_PROP(ValueFromText, ReadsBackEveryWrittenNumber, (double number)) {
  RC_PRE(std::isfinite(number));
  RC_ASSERT(value_from_text(to_string(Value(number))) == Value(number));
}

RC_GTEST_PROP(ValueFromText, ReadsBackEveryWrittenWholeNumber, (std::int64_t number)) {
  RC_ASSERT(value_from_text(to_string(Value(number))) == Value(number));
}

}  // namespace
}  // namespace culprit
