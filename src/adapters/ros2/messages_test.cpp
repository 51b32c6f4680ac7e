#include "ros2/messages.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "ros2/message_library.h"
#include "ros2/services.h"
#include "rtps/cdr.h"

namespace culprit::ros2::msg {
namespace {

// Bytes worked out by hand from the .msg files and the rules of XCDR1; none of them comes from our
// writer.
template <class Message>
void expect_golden(const Message& message, const rtps::Bytes& payload) {
  EXPECT_EQ(rtps::encode(message), payload);
  const auto read = rtps::decode<Message>(payload);
  ASSERT_TRUE(read);
  EXPECT_EQ(rtps::encode(*read), payload);
}

TEST(Messages, Float64IsEightBytes) {
  expect_golden(Float64{1.5}, {0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0xf8, 0x3f});
}

TEST(Messages, StateIsAByteAndAString) {
  expect_golden(State{3, "active"}, {0, 1, 0, 0,  //
                                     3, 0, 0, 0,  // id, padding
                                     7, 0, 0, 0, 'a', 'c', 't', 'i', 'v', 'e', 0});
}

TEST(Messages, TransitionEventStartsWithEightBytesOfTime) {
  expect_golden(
      TransitionEvent{
          .timestamp = 0, .transition = {}, .start_state = {1, "a"}, .goal_state = {10, "b"}},
      {0,  1, 0, 0,                     //
       0,  0, 0, 0, 0, 0, 0,   0,       // timestamp
       0,  0, 0, 0, 1, 0, 0,   0,   0,  // transition: id, padding, ""
       1,  0, 0, 2, 0, 0, 0,   'a', 0,  // start: id at 17, padding to 20, "a"
       10, 0, 2, 0, 0, 0, 'b', 0});     // goal: id at 26, padding to 28, "b"
}

TEST(Messages, DiagnosticArrayNestsStatusesAndValues) {
  DiagnosticStatus status{
      .level = 2, .name = "cam", .message = "x", .hardware_id = "", .values = {}};
  status.values.push_back({"k", "0.5"});
  DiagnosticArray array;
  array.header.stamp = {1, 2};
  array.status.push_back(status);
  expect_golden(array, {0, 1, 0, 0,                      //
                        1, 0, 0, 0, 2,   0,   0,   0,    // stamp
                        1, 0, 0, 0, 0,   0,   0,   0,    // frame_id "" at 8, padding to 16
                        1, 0, 0, 0,                      // one status
                        2, 0, 0, 0,                      // level, padding
                        4, 0, 0, 0, 'c', 'a', 'm', 0,    // name
                        2, 0, 0, 0, 'x', 0,   0,   0,    // message, padding to 40
                        1, 0, 0, 0, 0,   0,   0,   0,    // hardware_id, padding to 48
                        1, 0, 0, 0,                      // one value
                        2, 0, 0, 0, 'k', 0,   0,   0,    // key, padding
                        4, 0, 0, 0, '0', '.', '5', 0});  // value
}

TEST(Messages, ParameterValueHasEveryMember) {
  ParameterValue value;
  value.type = 3;
  value.double_value = 2;
  expect_golden(value, {0, 1, 0, 0,                             //
                        3, 0, 0, 0, 0, 0, 0, 0,                 // type, bool, padding to 8
                        0, 0, 0, 0, 0, 0, 0, 0,                 // integer
                        0, 0, 0, 0, 0, 0, 0, 0x40,              // double
                        1, 0, 0, 0, 0, 0, 0, 0,                 // string "", padding
                        0, 0, 0, 0, 0, 0, 0, 0,    0, 0, 0, 0,  // bytes, bools, integers: none
                        0, 0, 0, 0, 0, 0, 0, 0});               // doubles, strings: none
}

TEST(Messages, LogEndsWithItsLine) {
  expect_golden(Log{.stamp = {1, 0},
                    .level = 20,
                    .name = "n",
                    .msg = "m",
                    .file = "",
                    .function = "",
                    .line = 7},
                {0,  1, 0, 0, 1,   0, 0, 0, 0,   0, 0, 0,  // stamp
                 20, 0, 0, 0, 2,   0, 0, 0, 'n', 0, 0, 0,  // level, padding, name, padding
                 2,  0, 0, 0, 'm', 0, 0, 0,                // msg
                 1,  0, 0, 0, 0,   0, 0, 0,                // file
                 1,  0, 0, 0, 0,   0, 0, 0,                // function
                 7,  0, 0, 0});                            // line
}

TEST(Messages, RequestsWithoutFieldsAreOneByte) {
  EXPECT_EQ(rtps::encode(srv::GetState::Request{}), (rtps::Bytes{0, 1, 0, 0, 0}));
  EXPECT_EQ(rtps::encode(srv::Trigger::Request{}), (rtps::Bytes{0, 1, 0, 0, 0}));
}

TEST(Messages, ChangeModeIsAString) {
  EXPECT_EQ(rtps::encode(srv::ChangeMode::Request{"a"}),
            (rtps::Bytes{0, 1, 0, 0, 2, 0, 0, 0, 'a', 0}));
}

TEST(Messages, ListParametersAlignsItsDepth) {
  EXPECT_EQ(rtps::encode(srv::ListParameters::Request{{}, 1}),
            (rtps::Bytes{0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(Messages, TimeOfDayIsSecondsAndNanoseconds) {
  using namespace std::chrono_literals;
  EXPECT_EQ(to_time(std::chrono::system_clock::time_point(1500ms)), (Time{1, 500'000'000}));
}

// The built-in definition of a type has, field by field, what our struct writes: counts the fields
// that visit names.
struct FieldCounter {
  std::size_t count = 0;
  void operator()(const auto&... fields) { count += sizeof...(fields); }
};

template <class Message>
void expect_as_defined() {
  MessageLibrary library;
  const auto definition = library.find(Message::kType);
  ASSERT_TRUE(definition) << definition.error();
  FieldCounter counter;
  const Message message;
  Message::visit(message, counter);
  EXPECT_EQ(counter.count, (*definition)->fields.size()) << Message::kType;
}

TEST(Messages, HaveAsManyFieldsAsTheirDefinitions) {
  expect_as_defined<Time>();
  expect_as_defined<Header>();
  expect_as_defined<Bool>();
  expect_as_defined<Int32>();
  expect_as_defined<Float32>();
  expect_as_defined<Float64>();
  expect_as_defined<String>();
  expect_as_defined<KeyValue>();
  expect_as_defined<DiagnosticStatus>();
  expect_as_defined<DiagnosticArray>();
  expect_as_defined<Image>();
  expect_as_defined<Log>();
  expect_as_defined<State>();
  expect_as_defined<Transition>();
  expect_as_defined<TransitionDescription>();
  expect_as_defined<TransitionEvent>();
  expect_as_defined<ParameterValue>();
  expect_as_defined<Parameter>();
  expect_as_defined<ParameterEvent>();
}

template <class Message>
void read_or_refuse(const rtps::Bytes& bytes) {
  rtps::decode<Message>(bytes);
}

RC_GTEST_PROP(Messages, AnyBytesAreReadOrRefused, (rtps::Bytes bytes)) {
  bytes.insert(bytes.begin(), {0, static_cast<std::uint8_t>(*rc::gen::inRange(0, 2)), 0, 0});
  read_or_refuse<DiagnosticArray>(bytes);
  read_or_refuse<TransitionEvent>(bytes);
  read_or_refuse<ParameterEvent>(bytes);
  read_or_refuse<Image>(bytes);
  read_or_refuse<Log>(bytes);
  read_or_refuse<srv::DescribeParameters::Response>(bytes);
  read_or_refuse<srv::GetAvailableTransitions::Response>(bytes);
}

RC_GTEST_PROP(Messages, DiagnosticsSurviveTheWire,
              (std::vector<std::pair<std::string, std::string>> pairs)) {
  DiagnosticArray array;
  for (const auto& [key, value] : pairs) {
    DiagnosticStatus& status = array.status.emplace_back();
    status.name = value;
    status.values.push_back({key, value});
  }
  RC_ASSERT(rtps::decode<DiagnosticArray>(rtps::encode(array, rtps::Endianness::kBig)) == array);
  RC_ASSERT(rtps::decode<DiagnosticArray>(rtps::encode(array)) == array);
}

}  // namespace
}  // namespace culprit::ros2::msg
