#include "base/value_list.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit {
namespace {

using List = std::vector<Value>;

TEST(ValueList, IsReadAsPeopleWriteIt) {
  EXPECT_EQ(list_from_text("[]"), List());
  EXPECT_EQ(list_from_text(" [ 1,2 ] "), (List{std::int64_t{1}, std::int64_t{2}}));
  EXPECT_EQ(list_from_text("[0.5, 1e3]"), (List{0.5, 1000.0}));
  EXPECT_EQ(list_from_text("[true, false]"), (List{true, false}));
  EXPECT_EQ(list_from_text("[left, right wheel]"),
            (List{std::string("left"), std::string("right wheel")}));
  EXPECT_EQ(list_from_text(R"(["a, b]", "\"c\"", "1"])"),
            (List{std::string("a, b]"), std::string("\"c\""), std::string("1")}));
  for (const char* other : {"", "[", "]", "1, 2", "[1", "[1,]", "[,]", "[[1]]", "[{a: 1}]", "[1] 2",
                            "[\"open]", "[\"a\" b]", "text"}) {
    EXPECT_FALSE(list_from_text(other)) << other;
  }
}

RC_GTEST_PROP(ValueList, IsReadBackAsItIsWritten, ()) {
  const auto texts = *rc::gen::arbitrary<std::vector<std::string>>();
  const auto numbers = *rc::gen::arbitrary<std::vector<std::int64_t>>();
  List list(texts.begin(), texts.end());
  list.insert(list.end(), numbers.begin(), numbers.end());
  RC_ASSERT(list_from_text(text_of_list(list)) == list);
}

}  // namespace
}  // namespace culprit
