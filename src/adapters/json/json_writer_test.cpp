#include "json/json_writer.h"

#include <limits>

#include <gtest/gtest.h>

#include "json/json.h"

namespace culprit {
namespace {

template <class T>
std::string written(const T& value) {
  std::string text;
  JsonWriter(text).value(value);
  return text;
}

// Rows of journals are compared by their bytes.
TEST(JsonWriter, WritesValuesAsDocumentsPrintThem) {
  for (const char* text : {"", "plain", "a \"b\" \\ /", "line\nnext\ttab", "\x01\x7f", "naïve ☃",
                           "caf\xE9", "\xED\xA0\x80"})
    EXPECT_EQ(written(text), to_line(Json(text))) << text;
  EXPECT_EQ(written(std::string("a\0b", 3)), to_line(Json(std::string("a\0b", 3))));
  using Double = std::numeric_limits<double>;
  for (const double number : {0.0, -0.0, 1.0, 0.1, 1e-7, 123456789.5, 1e15, 1e16, 1e300, -2.5e-300,
                              Double::quiet_NaN(), Double::infinity(), Double::denorm_min()})
    EXPECT_EQ(written(number), to_line(Json(number))) << number;
  EXPECT_EQ(written(std::numeric_limits<std::int64_t>::min()), "-9223372036854775808");
  EXPECT_EQ(written(std::numeric_limits<std::uint64_t>::max()), "18446744073709551615");
  EXPECT_EQ(written(-7), "-7");
  EXPECT_EQ(written(true), "true");
  EXPECT_EQ(written(false), "false");
}

TEST(JsonWriter, WritesObjectsAndArraysInOneAnother) {
  std::string text = "row ";
  JsonWriter json(text);
  json.begin_object();
  json.member("first", 1);
  json.member("none", [&] { json.null(); });
  json.member("empty", [&] {
    json.begin_array();
    json.end_array();
  });
  json.member("all", [&] {
    json.begin_array();
    for (const char* name : {"a", "b"}) {
      json.begin_object();
      json.member("name", name);
      json.end_object();
    }
    json.value(0.5);
    json.end_array();
  });
  json.member("last", true);
  json.end_object();
  EXPECT_EQ(text, R"(row {"first":1,"none":null,"empty":[],"all":[{"name":"a"},{"name":"b"},0.5],)"
                  R"("last":true})");
}

}  // namespace
}  // namespace culprit
