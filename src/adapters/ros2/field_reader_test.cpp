#include "ros2/field_reader.h"

#include <filesystem>
#include <fstream>
#include <limits>
#include <unistd.h>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "base/test_folder.h"
#include "ros2/messages.h"
#include "ros2/test_xcdr2.h"

namespace culprit::ros2 {
namespace {

FieldReader reader_of(std::string_view type, std::string_view path) {
  MessageLibrary library;
  auto reader = FieldReader::compile(library, type, path);
  if (!reader) {
    ADD_FAILURE() << reader.error();
    return {};
  }
  return *reader;
}

std::string compile_error(std::string_view type, std::string_view path) {
  MessageLibrary library;
  const auto reader = FieldReader::compile(library, type, path);
  return reader ? "none" : reader.error();
}

// The value, or the status in words.
Value read(std::string_view type, std::string_view path, rtps::ByteView payload) {
  Value value = std::string("untouched");
  switch (reader_of(type, path).read(payload, value)) {
    case FieldStatus::kRead:
      return value;
    case FieldStatus::kAbsent:
      return std::string("absent");
    case FieldStatus::kMalformed:
      return std::string("malformed");
  }
  return value;
}

Value text(std::string_view t) { return std::string(t); }

msg::DiagnosticArray two_statuses() {
  msg::DiagnosticArray array;
  array.header.frame_id = "frame";
  for (const char* name : {"first", "second"}) {
    msg::DiagnosticStatus& status = array.status.emplace_back();
    status.name = name;
    status.level = static_cast<std::uint8_t>(array.status.size());
    status.values.push_back({"a", name});
    status.values.push_back({"b", "2"});
  }
  return array;
}

TEST(FieldReader, ReadsAPlainField) {
  EXPECT_EQ(read("std_msgs/msg/Float64", "data", rtps::encode(msg::Float64{2.5})), Value(2.5));
  EXPECT_EQ(read("std_msgs/msg/Bool", "data", rtps::encode(msg::Bool{true})), Value(true));
  EXPECT_EQ(read("std_msgs/msg/Float32", "data", rtps::encode(msg::Float32{0.5f})), Value(0.5));
  EXPECT_EQ(read("std_msgs/msg/Int32", "data", rtps::encode(msg::Int32{-7})),
            Value(std::int64_t{-7}));
  EXPECT_EQ(read("std_msgs/msg/String", "data", rtps::encode(msg::String{"hello"})), text("hello"));
}

TEST(FieldReader, ReadsAnElementByItsName) {
  const rtps::Bytes payload = rtps::encode(two_statuses());
  constexpr std::string_view kType = "diagnostic_msgs/msg/DiagnosticArray";
  EXPECT_EQ(read(kType, "status[second].level", payload), Value(std::int64_t{2}));
  EXPECT_EQ(read(kType, "status[second].values[b].value", payload), text("2"));
  EXPECT_EQ(read(kType, "status[second].values[a].value", payload), text("second"));
  EXPECT_EQ(read(kType, "status[third].level", payload), text("absent"));
  EXPECT_NE(compile_error("sensor_msgs/msg/LaserScan", "ranges[left]"), "none");
}

// A sensor_msgs/msg/JointState with these joints; effort has one element less.
rtps::Bytes joints() {
  rtps::CdrWriter writer;
  writer.write(std::int32_t{0});
  writer.write(std::uint32_t{0});
  writer.write_string("");
  writer.write(std::uint32_t{3});
  for (const char* name : {"base", "elbow", "wrist"}) writer.write_string(name);
  for (const std::uint32_t count : {3u, 3u, 2u}) {
    writer.write(count);
    for (std::uint32_t i = 0; i < count; ++i) writer.write(10.0 * count + i);
  }
  return writer.take();
}

TEST(FieldReader, ReadsAnElementByTheArrayOfNamesBeside) {
  constexpr std::string_view kType = "sensor_msgs/msg/JointState";
  EXPECT_EQ(read(kType, "position[elbow]", joints()), Value(31.0));
  EXPECT_EQ(read(kType, "effort[elbow]", joints()), Value(21.0));
  EXPECT_EQ(read(kType, "effort[wrist]", joints()), text("absent"));
  EXPECT_EQ(read(kType, "effort[tail]", joints()), text("absent"));
}

TEST(FieldReader, ReadsTheLeastAndTheGreatestOfAnArray) {
  constexpr std::string_view kType = "sensor_msgs/msg/JointState";
  EXPECT_EQ(read(kType, "min(position)", joints()), Value(30.0));
  EXPECT_EQ(read(kType, "max(effort)", joints()), Value(21.0));
  EXPECT_NE(compile_error(kType, "max(name)"), "none");
  EXPECT_NE(compile_error(kType, "max(header.stamp)"), "none");
}

TEST(FieldReader, ReadsHowLongAfterItsStampAMessageCame) {
  msg::DiagnosticArray array = two_statuses();
  array.header.stamp = {1000, 500'000'000};
  MessageLibrary library;
  const auto reader =
      FieldReader::compile(library, "diagnostic_msgs/msg/DiagnosticArray", "delay(header.stamp)");
  ASSERT_TRUE(reader) << reader.error();
  Value value;
  EXPECT_EQ(reader->read(rtps::encode(array), value, 1'000'750'000'000), FieldStatus::kRead);
  EXPECT_EQ(value, Value(0.25));
  array.header.stamp = {0, 0};
  EXPECT_EQ(reader->read(rtps::encode(array), value, 1'000'750'000'000), FieldStatus::kAbsent);
  EXPECT_NE(compile_error("diagnostic_msgs/msg/DiagnosticArray", "delay(status)"), "none");
}

TEST(FieldReader, SaysWhetherAPayloadFitsItsType) {
  MessageLibrary library;
  const auto whole = FieldReader::compile_whole(library, "diagnostic_msgs/msg/DiagnosticArray");
  ASSERT_TRUE(whole) << whole.error();
  rtps::Bytes payload = rtps::encode(two_statuses());
  EXPECT_EQ(whole->fit(payload), PayloadFit::kFits);
  payload.insert(payload.end(), 8, 0);
  EXPECT_EQ(whole->fit(payload), PayloadFit::kTooLong);
  payload.resize(payload.size() - 12);
  EXPECT_EQ(whole->fit(payload), PayloadFit::kMalformed);
  payload = rtps::encode(two_statuses());
  payload[1] = 7;  // XCDR2 has no padding before 64 bits, and headers before the statuses
  EXPECT_NE(whole->fit(payload), PayloadFit::kFits);
  payload[1] = 3;  // PL_CDR of XCDR1, which no message has
  EXPECT_EQ(whole->fit(payload), PayloadFit::kMalformed);
}

struct JointState {
  static constexpr std::string_view kType = "sensor_msgs/msg/JointState";
  msg::Header header;
  std::vector<std::string> name;
  std::vector<double> position, velocity, effort;
  static void visit(auto& self, auto& each) {
    each(self.header, self.name, self.position, self.velocity, self.effort);
  }
  bool operator==(const JointState&) const = default;
};

TEST(FieldReader, ReadsXcdrTwoInAllItsForms) {
  const JointState joints{{{1000, 5}, "base"}, {"wrist", "elbow"}, {0.5}, {}, {2, 9, 1}};
  constexpr std::string_view kStatuses = "diagnostic_msgs/msg/DiagnosticArray";
  MessageLibrary library;
  const auto whole = FieldReader::compile_whole(library, kStatuses);
  const auto delay = FieldReader::compile(library, JointState::kType, "delay(header.stamp)");
  ASSERT_TRUE(whole && delay);
  for (const Xcdr2 form : {Xcdr2::kPlain, Xcdr2::kDelimited, Xcdr2::kMembers}) {
    for (const rtps::Endianness endianness : {rtps::Endianness::kLittle, rtps::Endianness::kBig}) {
      SCOPED_TRACE(static_cast<int>(form));
      const rtps::Bytes statuses = encode_xcdr2(two_statuses(), form, endianness);
      EXPECT_EQ(read(kStatuses, "status[1].level", statuses), Value(std::int64_t{2}));
      EXPECT_EQ(read(kStatuses, "status[1].values[1].value", statuses), text("2"));
      EXPECT_EQ(read(kStatuses, "status[second].values[a].value", statuses), text("second"));
      EXPECT_EQ(read(kStatuses, "status[third].level", statuses), text("absent"));
      EXPECT_EQ(whole->fit(statuses), PayloadFit::kFits);
      EXPECT_EQ(rtps::decode<msg::DiagnosticArray>(statuses), two_statuses());
      const rtps::Bytes cut(statuses.begin(), statuses.end() - 8);
      EXPECT_EQ(whole->fit(cut), PayloadFit::kMalformed);

      rtps::Bytes state = encode_xcdr2(joints, form, endianness);
      EXPECT_EQ(read(JointState::kType, "effort[elbow]", state), Value(9.0));
      EXPECT_EQ(read(JointState::kType, "min(effort)", state), Value(1.0));
      EXPECT_EQ(read(JointState::kType, "name[1]", state), text("elbow"));
      EXPECT_EQ(rtps::decode<JointState>(state), joints);
      Value late;
      EXPECT_EQ(delay->read(state, late, 1'001'000'000'005), FieldStatus::kRead);
      EXPECT_EQ(late, Value(1.0));
      // As DDS-XTypes numbers it.
      state[1] = static_cast<std::uint8_t>((form == Xcdr2::kPlain       ? 0x10
                                            : form == Xcdr2::kDelimited ? 0x14
                                                                        : 0x12) |
                                           (state[1] & 1));
      EXPECT_EQ(read(JointState::kType, "effort[wrist]", state), Value(2.0));
    }
  }
}

TEST(FieldReader, ReadsThroughNestedMessagesAndArrays) {
  for (const rtps::Endianness endianness : {rtps::Endianness::kLittle, rtps::Endianness::kBig}) {
    const rtps::Bytes payload = rtps::encode(two_statuses(), endianness);
    constexpr std::string_view kType = "diagnostic_msgs/msg/DiagnosticArray";
    EXPECT_EQ(read(kType, "header.frame_id", payload), text("frame"));
    EXPECT_EQ(read(kType, "status[0].name", payload), text("first"));
    EXPECT_EQ(read(kType, "status[1].level", payload), Value(std::int64_t{2}));
    EXPECT_EQ(read(kType, "status[1].values[0].value", payload), text("second"));
    EXPECT_EQ(read(kType, "status[1].values[1].value", payload), text("2"));
  }
}

TEST(FieldReader, AnIndexBehindTheEndIsAbsent) {
  const rtps::Bytes payload = rtps::encode(two_statuses());
  EXPECT_EQ(read("diagnostic_msgs/msg/DiagnosticArray", "status[2].name", payload), text("absent"));
  EXPECT_EQ(read("diagnostic_msgs/msg/DiagnosticArray", "status[1].values[2].key", payload),
            text("absent"));
}

// nav_msgs/Odometry by hand: a header, a frame, pose (7 doubles), covariance (36), twist (6),
// covariance (36).
TEST(FieldReader, ReadsFarIntoOdometry) {
  rtps::CdrWriter writer;
  writer(std::int32_t{1}, std::uint32_t{2}, std::string("odom"), std::string("base"));
  for (int i = 0; i < 7 + 36 + 6 + 36; ++i) writer.write(static_cast<double>(i));
  const rtps::Bytes payload = writer.take();
  constexpr std::string_view kType = "nav_msgs/msg/Odometry";
  EXPECT_EQ(read(kType, "child_frame_id", payload), text("base"));
  EXPECT_EQ(read(kType, "pose.pose.position.x", payload), Value(0.0));
  EXPECT_EQ(read(kType, "pose.pose.orientation.w", payload), Value(6.0));
  EXPECT_EQ(read(kType, "pose.covariance[35]", payload), Value(42.0));
  EXPECT_EQ(read(kType, "twist.twist.angular.z", payload), Value(48.0));
  EXPECT_EQ(read(kType, "twist.covariance[0]", payload), Value(49.0));
}

TEST(FieldReader, ReadsBehindSequencesOfPrimitives) {
  rtps::CdrWriter writer;  // sensor_msgs/JointState
  writer(std::int32_t{1}, std::uint32_t{2}, std::string("f"),
         std::vector<std::string>{"left", "right"}, std::vector<double>{1, 2},
         std::vector<double>{}, std::vector<double>{5});
  const rtps::Bytes payload = writer.take();
  EXPECT_EQ(read("sensor_msgs/msg/JointState", "name[1]", payload), text("right"));
  EXPECT_EQ(read("sensor_msgs/msg/JointState", "position[1]", payload), Value(2.0));
  EXPECT_EQ(read("sensor_msgs/msg/JointState", "velocity[0]", payload), text("absent"));
  EXPECT_EQ(read("sensor_msgs/msg/JointState", "effort[0]", payload), Value(5.0));
}

TEST(FieldReader, Uint64Saturates) {
  rtps::CdrWriter writer;
  writer.write(std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(read("std_msgs/msg/UInt64", "data", writer.take()),
            Value(std::numeric_limits<std::int64_t>::max()));
}

TEST(FieldReader, FalseCountsAreMalformed) {
  const rtps::Bytes payload{0,    1,    0,    0,                                        //
                            0,    0,    0,    0,   0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0,  // header
                            0xff, 0xff, 0xff, 0xff};  // four billion statuses
  EXPECT_EQ(read("diagnostic_msgs/msg/DiagnosticArray", "status[5].name", payload),
            text("malformed"));
  EXPECT_EQ(read("diagnostic_msgs/msg/DiagnosticArray", "status[4000000000].name", payload),
            text("malformed"));
}

TEST(FieldReader, ErrorsSayWhatThereIs) {
  EXPECT_EQ(compile_error("std_msgs/msg/Float64", "value"),
            "std_msgs/msg/Float64 has no field 'value'; its fields are data");
  EXPECT_EQ(compile_error("geometry_msgs/msg/PoseStamped", "pose.position"),
            "'pose.position' is a whole geometry_msgs/msg/Point; go on to one of its fields");
  EXPECT_EQ(compile_error("sensor_msgs/msg/LaserScan", "ranges"),
            "'ranges' is an array; write ranges[0] for its first element");
  EXPECT_EQ(compile_error("std_msgs/msg/Float64", "data[0]"), "'data' is not an array");
  EXPECT_EQ(compile_error("std_msgs/msg/Float64", "data.x"),
            "'data' is a value and has no field 'x'");
  EXPECT_EQ(compile_error("geometry_msgs/msg/PoseWithCovariance", "covariance[36]"),
            "'covariance' has 36 elements, the last is covariance[35]");
  for (const char* path : {"", ".", "data.", "data[", "data[]", "data[x]", "data[1", "data]",
                           "a..b", "[0]", "data[-1]", "data[99999999999]"}) {
    EXPECT_NE(compile_error("std_msgs/msg/Float64", path), "none") << path;
  }
}

TEST(FieldReader, EmptyMessagesTakeAByte) {
  const test::TestFolder own;
  const auto& directory = own.path();
  std::filesystem::create_directories(directory / "my_msgs/msg");
  std::ofstream(directory / "my_msgs/msg/Holder.msg") << "std_msgs/Empty nothing\nuint8 after\n";
  std::ofstream(directory / "my_msgs/msg/Loop.msg") << "Loop again\nuint8 after\n";
  std::ofstream(directory / "my_msgs/msg/Wide.msg") << "wstring wide\nuint8 after\n";
  MessageLibrary library({directory});
  const auto reader = FieldReader::compile(library, "my_msgs/msg/Holder", "after");
  const auto loop = FieldReader::compile(library, "my_msgs/msg/Loop", "after");
  const auto wide = FieldReader::compile(library, "my_msgs/msg/Wide", "after");

  ASSERT_TRUE(reader);
  Value value;
  EXPECT_EQ(reader->read(rtps::Bytes{0, 1, 0, 0, 0, 9}, value), FieldStatus::kRead);
  EXPECT_EQ(value, Value(std::int64_t{9}));
  EXPECT_EQ(loop.error(), "the message type nests too deep, or is defined by itself");
  EXPECT_FALSE(wide);
}

RC_GTEST_PROP(FieldReader, AgreesWithTheFullDecoder, ()) {
  msg::DiagnosticArray array;
  const auto count = *rc::gen::inRange(0, 4);
  for (int i = 0; i < count; ++i) {
    msg::DiagnosticStatus& status = array.status.emplace_back();
    status.level = *rc::gen::arbitrary<std::uint8_t>();
    status.name = *rc::gen::string<std::string>();
    const auto values = *rc::gen::inRange(0, 3);
    for (int j = 0; j < values; ++j) {
      msg::KeyValue& pair = status.values.emplace_back();
      pair.key = *rc::gen::string<std::string>();
      pair.value = *rc::gen::string<std::string>();
    }
  }
  const rtps::Bytes payload =
      rtps::encode(array, *rc::gen::element(rtps::Endianness::kLittle, rtps::Endianness::kBig));
  constexpr std::string_view kType = "diagnostic_msgs/msg/DiagnosticArray";
  for (std::size_t i = 0; i < 4; ++i) {
    const std::string at = "status[" + std::to_string(i) + "]";
    const bool is_there = i < array.status.size();
    RC_ASSERT(read(kType, at + ".name", payload) ==
              (is_there ? text(array.status[i].name) : text("absent")));
    for (std::size_t j = 0; is_there && j < 3; ++j) {
      const auto& values = array.status[i].values;
      RC_ASSERT(read(kType, at + ".values[" + std::to_string(j) + "].value", payload) ==
                (j < values.size() ? text(values[j].value) : text("absent")));
    }
  }
}

RC_GTEST_PROP(FieldReader, AnyBytesAreReadOrRefused, (rtps::Bytes bytes)) {
  static const FieldReader reader =
      reader_of("diagnostic_msgs/msg/DiagnosticArray", "status[2].values[1].value");
  bytes.insert(bytes.begin(), {0, 1, 0, 0});
  Value value;
  reader.read(bytes, value);
}

}  // namespace
}  // namespace culprit::ros2
