#include "ros_api/message_codec.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "ros2/message_library.h"
#include "ros2/services.h"

namespace culprit::ros_api {
namespace {

using testing::HasSubstr;

// A type with every kind of field.
MessageType test_type(const std::string& text) {
  ros2::MessageLibrary library;
  library.learn("t/msg/Part", "string name\nfloat64 weight\n");
  library.learn("t/msg/Empty", "");
  library.learn("t/msg/Whole", text);
  return {"t/msg/Whole", *library.with_parts("t/msg/Whole"), *library.hash_of("t/msg/Whole")};
}

Json there_and_back(const Json& document, const MessageType& type) {
  const auto payload = encode(document, type);
  EXPECT_TRUE(payload) << payload.error();
  const auto back = decode(*payload, type);
  EXPECT_TRUE(back) << back.error();
  return *back;
}

std::string error_of(const Json& document, const MessageType& type) {
  const auto payload = encode(document, type);
  return payload ? "" : payload.error();
}

TEST(MessageCodec, BringsAMessageThereAndBack) {
  const MessageType type = test_type(
      "bool flag\nint8 small\nuint64 large\nfloat32 share\nstring text\nPart part\nPart[] parts\n"
      "uint8[3] bytes\nstring[<=2] few\nEmpty nothing\nint16 last\n");
  const Json document{
      {"flag", true},
      {"small", -128},
      {"large", 18446744073709551615u},
      {"share", 0.25},
      {"text", "gr\u00fc\u00df dich"},
      {"part", {{"name", "a"}, {"weight", 1.5}}},
      {"parts", {{{"name", "b"}, {"weight", 2.5}}, {{"name", ""}, {"weight", 0.0}}}},
      {"bytes", {1, 2, 255}},
      {"few", {"x", "yz"}},
      {"nothing", Json::object()},
      {"last", 7}};
  EXPECT_EQ(there_and_back(document, type), document);
}

// Field for field as another encoder has it.
TEST(MessageCodec, WritesWhatRos2Reads) {
  const MessageType type = test_type("bool success\nstring message\n");
  const auto ours = encode({{"success", true}, {"message", "paused"}}, type);
  ASSERT_TRUE(ours) << ours.error();
  EXPECT_EQ(*ours, rtps::encode(ros2::srv::Trigger::Response{true, "paused"}));
}

TEST(MessageCodec, AFieldThatIsNotSaidIsZero) {
  const MessageType type = test_type("uint8 a\nPart part\nPart[] parts\nfloat64[2] two\nuint8 b\n");
  const Json zero{{"a", 0},
                  {"part", {{"name", ""}, {"weight", 0.0}}},
                  {"parts", Json::array()},
                  {"two", {0.0, 0.0}},
                  {"b", 5}};
  EXPECT_EQ(there_and_back({{"b", 5}}, type), zero);
}

TEST(MessageCodec, ANumberThatIsNotKnownIsNotANumber) {
  const MessageType type = test_type("float64 cost\n");
  EXPECT_TRUE(std::isnan(there_and_back({{"cost", nullptr}}, type)["cost"].get<double>()));
}

TEST(MessageCodec, SaysWhatDoesNotFit) {
  const MessageType type =
      test_type("uint8 a\nstring text\nPart[] parts\nuint8[2] two\nuint8[<=1] few\n");
  EXPECT_THAT(error_of({{"a", 256}}, type), HasSubstr("a does not fit"));
  EXPECT_THAT(error_of({{"a", -1}}, type), HasSubstr("a does not fit"));
  EXPECT_THAT(error_of({{"a", 0.5}}, type), HasSubstr("a does not fit"));
  EXPECT_THAT(error_of({{"text", 3}}, type), HasSubstr("text is no text"));
  EXPECT_THAT(error_of({{"parts", {{{"nam", "a"}}}}}, type),
              HasSubstr("parts has a member that t/msg/Part has not"));
  EXPECT_THAT(error_of({{"b", 1}}, type), HasSubstr("has a member"));
  EXPECT_THAT(error_of({{"two", {1}}}, type), HasSubstr("two has not as many elements"));
  EXPECT_THAT(error_of({{"few", {1, 2}}}, type), HasSubstr("few has too many elements"));
}

TEST(MessageCodec, ATextThatIsNoUtf8IsMendedOnTheWayOutAndRefusedOnTheWayIn) {
  const MessageType type = test_type("string text\n");
  const std::string bad = "a\xff\xfe z";
  EXPECT_EQ(there_and_back({{"text", bad}}, type)["text"], "a\ufffd\ufffd z");
  rtps::CdrWriter writer;
  writer.write_string(bad);
  const auto refused = decode(writer.take(), type);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error(), HasSubstr("UTF-8"));
}

TEST(MessageCodec, WhatIsNoMessageIsRefused) {
  const MessageType type = test_type("string text\nuint32 a\n");
  EXPECT_FALSE(decode({}, type));
  const auto whole = *encode({{"text", "abc"}}, type);
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(decode(rtps::ByteView(whole).first(size), type)) << size;
  EXPECT_TRUE(decode(whole, type));
}

// For any bytes: an order is read or refused, with no more memory than it has bytes.
RC_GTEST_PROP(MessageCodec, AnyBytesAreReadOrRefused, (rtps::Bytes bytes)) {
  static const CulpritTypes types;
  bytes.insert(bytes.begin(), {0, 1, 0, 0});
  for (const char* name : {"culprit_msgs/msg/Status", "culprit_msgs/srv/Silence_Request"}) {
    const MessageType& type = types.message(name);
    if (const auto read = decode(bytes, type)) RC_ASSERT(encode(*read, type).has_value());
  }
}

}  // namespace
}  // namespace culprit::ros_api
