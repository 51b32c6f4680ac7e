#include "json/json.h"

#include <string>

#include <gtest/gtest.h>

namespace culprit {
namespace {

TEST(Json, KeepsMembersInTheOrderInWhichTheyWereWritten) {
  const std::string text = R"({"z":1,"a":{"y":[true,null],"b":"x"}})";
  EXPECT_EQ(to_line(parse_json(text)), text);
  EXPECT_EQ(to_indented(parse_json(R"({"z":[1],"a":2})")),
            "{\n  \"z\": [\n    1\n  ],\n  \"a\": 2\n}");
}

TEST(Json, IsDiscardedWhereItIsNone) {
  for (const char* text : {"", "{", "[1,]", "{\"a\":1} b", "'a'", "\"\xFF\"", "1e999999"})
    EXPECT_TRUE(parse_json(text).is_discarded()) << text;
  EXPECT_TRUE(parse_json(std::string(100'000, '[')).is_discarded());
}

TEST(Json, IsDiscardedWhereItIsDeeperThanTheStackBears) {
  const auto nested = [](int depth) {
    std::string text;
    for (int i = 0; i < depth; ++i) text += i % 2 == 0 ? "[" : "{\"]\\\"\": ";
    for (int i = depth; i-- > 0;) text += i % 2 == 0 ? "]" : "}";
    return text;
  };
  EXPECT_FALSE(parse_json("[[], " + nested(499) + "]").is_discarded());
  EXPECT_TRUE(parse_json("[[], " + nested(501) + "]").is_discarded());
  EXPECT_TRUE(parse_json(std::string(1'000'000, '[') + std::string(1'000'000, ']')).is_discarded());
  EXPECT_FALSE(parse_json('"' + std::string(1'000'000, '[') + '"').is_discarded()) << "a text";
}

TEST(Json, IsWrittenWhereATextIsNoUtf8) {
  EXPECT_EQ(to_line({{"name", "caf\xE9"}}), "{\"name\":\"caf\xEF\xBF\xBD\"}");
  EXPECT_EQ(to_indented(Json("caf\xE9")), "\"caf\xEF\xBF\xBD\"");
}

TEST(StrictJson, HasNoMemberTwiceAndIsNotDeep) {
  EXPECT_EQ(parse_strict_json(R"({"a": 1, "b": {"a": [{"a": 2}, {"a": 3}]}})"),
            parse_json(R"({"a": 1, "b": {"a": [{"a": 2}, {"a": 3}]}})"));
  for (const char* bad : {R"({"a": 1, "a": 1})", R"([{"b": {"a": 1, "c": 2, "a": 3}}])",
                          R"({"a": 1, "\u0061": 2})", "{", "", R"({"a": 1}})"})
    EXPECT_TRUE(parse_strict_json(bad).is_discarded()) << bad;
  const std::string deep = std::string(100'000, '[') + std::string(100'000, ']');
  EXPECT_TRUE(parse_strict_json(deep).is_discarded());
  EXPECT_FALSE(parse_strict_json(deep.substr(99'950, 100)).is_discarded());
}

}  // namespace
}  // namespace culprit
