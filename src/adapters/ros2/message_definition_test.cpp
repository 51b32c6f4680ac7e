#include "ros2/message_definition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit::ros2 {
namespace {

Expected<MessageDefinition> parse(std::string_view text) {
  return parse_message_definition(text, "my_msgs/msg/Thing", "Thing.msg");
}

FieldDefinition only_field(std::string_view text) {
  const auto parsed = parse(text);
  if (!parsed) ADD_FAILURE() << parsed.error();
  if (!parsed || parsed->fields.size() != 1) return {};
  return parsed->fields.front();
}

std::string error_of(std::string_view text) {
  const auto parsed = parse(text);
  return parsed ? "none" : parsed.error();
}

TEST(MessageDefinition, ReadsEveryPrimitive) {
  const auto parsed = parse(
      "bool a\nbyte b\nchar c\nint8 d\nuint8 e\nint16 f\nuint16 g\nint32 h\nuint32 i\nint64 "
      "j\nuint64 k\n"
      "float32 l\nfloat64 m\nstring n\nwstring o\n");
  ASSERT_TRUE(parsed);
  ASSERT_EQ(parsed->fields.size(), 15u);
  for (std::size_t i = 0; i < 15; ++i) {
    EXPECT_EQ(std::get<Primitive>(parsed->fields[i].element), static_cast<Primitive>(i));
    EXPECT_EQ(parsed->fields[i].name, std::string(1, static_cast<char>('a' + i)));
  }
}

TEST(MessageDefinition, ReadsArrays) {
  EXPECT_EQ(only_field("float32[36] c").shape, Shape::kArray);
  EXPECT_EQ(only_field("float32[36] c").count, 36u);
  EXPECT_EQ(only_field("float32[] c").shape, Shape::kSequence);
  EXPECT_EQ(only_field("float32[<=5] c").shape, Shape::kSequence);
  EXPECT_EQ(only_field("string<=10[<=5] c").shape, Shape::kSequence);
  EXPECT_EQ(only_field("string<=10 c").shape, Shape::kSingle);
}

TEST(MessageDefinition, ReadsMessageTypes) {
  EXPECT_EQ(std::get<std::string>(only_field("Other x").element), "my_msgs/msg/Other");
  EXPECT_EQ(std::get<std::string>(only_field("geometry_msgs/Pose x").element),
            "geometry_msgs/msg/Pose");
  EXPECT_EQ(std::get<std::string>(only_field("geometry_msgs/msg/Pose[] x").element),
            "geometry_msgs/msg/Pose");
  EXPECT_EQ(std::get<std::string>(only_field("Header header").element), "std_msgs/msg/Header");
}

TEST(MessageDefinition, DropsConstantsDefaultsAndComments) {
  const auto parsed = parse(
      "# a comment\n"
      "\n"
      "uint8 OK=0\n"
      "uint8 WARN = 1   # with blanks\n"
      "string NAME=\"a # b\"\n"
      "string EMPTY=\n"
      "  \t# an indented comment\r\n"
      "int32 x 5\n"
      "int32[] y [1, 2]  # default array\n"
      "string z 'it''s'\n"
      "float64\tw#comment\n");
  ASSERT_TRUE(parsed) << parsed.error();
  ASSERT_EQ(parsed->fields.size(), 4u);
  EXPECT_EQ(parsed->fields[0].name, "x");
  EXPECT_EQ(parsed->fields[3].name, "w");
}

TEST(MessageDefinition, AnEmptyFileIsAnEmptyMessage) {
  ASSERT_TRUE(parse(""));
  EXPECT_TRUE(parse("# nothing\n")->fields.empty());
}

TEST(MessageDefinition, ErrorsNameFileAndLine) {
  EXPECT_EQ(error_of("int32 a\nint32\n"),
            "Thing.msg:2: 'int32' is not followed by the name of a field");
  EXPECT_EQ(error_of("int32 1a"), "Thing.msg:1: '1a' cannot be the name of a field");
  EXPECT_EQ(error_of("int32 a\n\nint32 a"), "Thing.msg:3: there are two fields with the name 'a'");
  EXPECT_EQ(error_of("int32[0] a"), "Thing.msg:1: '0' is not the size of an array");
  EXPECT_EQ(error_of("int32[x] a"), "Thing.msg:1: 'x' is not the size of an array");
  EXPECT_EQ(error_of("int32[<=] a"), "Thing.msg:1: '' is not the size of an array");
  EXPECT_EQ(error_of("int32] a"), "Thing.msg:1: 'int32]' lacks a '['");
  EXPECT_EQ(error_of("int32<=5 a"), "Thing.msg:1: only strings have a bound, not 'int32'");
  EXPECT_EQ(error_of("string<=0 a"), "Thing.msg:1: '0' is not the size of a string");
  EXPECT_EQ(error_of("a-b c"), "Thing.msg:1: 'a-b' is not the name of a type");
  EXPECT_EQ(error_of("a/b/C c"), "Thing.msg:1: 'a/b/C' is not the name of a type");
  EXPECT_EQ(error_of("uint8 X="), "Thing.msg:1: the constant 'X' has no value");
  EXPECT_EQ(error_of("Pose X=1"), "Thing.msg:1: the constant 'X' is not of a primitive type");
  EXPECT_EQ(error_of("int32[] X=1"), "Thing.msg:1: the constant 'X' is not of a primitive type");
  EXPECT_EQ(error_of("int32[] x [1, 2"),
            "Thing.msg:1: the default value opens with [ and does not close");
}

RC_GTEST_PROP(MessageDefinition, AnyTextIsReadOrRefused, (std::string text)) {
  const auto parsed = parse(text);
  if (!parsed) RC_ASSERT(parsed.error().starts_with("Thing.msg:"));
}

}  // namespace
}  // namespace culprit::ros2
