// The message types that this link itself speaks: to be a node, to read and steer nodes, to read
// diagnostics.
//
// Each is wire-identical in every ROS 2 distribution from Humble on. Field for field as in the .msg
// file that kType names. Types that only rules read are not here: message_definition.h reads those
// at run time.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace culprit::ros2::msg {

// Bytes of a report that anybody may send, as diagnostics; larger ones are not decoded. Nodes send far smaller ones, and
// decoded they are a multiple of that.
inline constexpr std::size_t kLargestReport = std::size_t{4} << 20;

struct Time {
  static constexpr std::string_view kType = "builtin_interfaces/msg/Time";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  static void visit(auto& self, auto& each) { each(self.sec, self.nanosec); }
  bool operator==(const Time&) const = default;
};

inline Time to_time(std::chrono::system_clock::time_point t) {
  const std::int64_t ns =
      std::chrono::duration_cast<std::chrono::nanoseconds>(t.time_since_epoch()).count();
  return {static_cast<std::int32_t>(ns / 1'000'000'000),
          static_cast<std::uint32_t>(ns % 1'000'000'000)};
}

struct Header {
  static constexpr std::string_view kType = "std_msgs/msg/Header";
  Time stamp;
  std::string frame_id;
  static void visit(auto& self, auto& each) { each(self.stamp, self.frame_id); }
  bool operator==(const Header&) const = default;
};

struct Bool {
  static constexpr std::string_view kType = "std_msgs/msg/Bool";
  bool data = false;
  static void visit(auto& self, auto& each) { each(self.data); }
  bool operator==(const Bool&) const = default;
};

struct Int32 {
  static constexpr std::string_view kType = "std_msgs/msg/Int32";
  std::int32_t data = 0;
  static void visit(auto& self, auto& each) { each(self.data); }
  bool operator==(const Int32&) const = default;
};

struct Float32 {
  static constexpr std::string_view kType = "std_msgs/msg/Float32";
  float data = 0;
  static void visit(auto& self, auto& each) { each(self.data); }
  bool operator==(const Float32&) const = default;
};

struct Float64 {
  static constexpr std::string_view kType = "std_msgs/msg/Float64";
  double data = 0;
  static void visit(auto& self, auto& each) { each(self.data); }
  bool operator==(const Float64&) const = default;
};

struct String {
  static constexpr std::string_view kType = "std_msgs/msg/String";
  std::string data;
  static void visit(auto& self, auto& each) { each(self.data); }
  bool operator==(const String&) const = default;
};

struct KeyValue {
  static constexpr std::string_view kType = "diagnostic_msgs/msg/KeyValue";
  std::string key;
  std::string value;
  static void visit(auto& self, auto& each) { each(self.key, self.value); }
  bool operator==(const KeyValue&) const = default;
};

struct DiagnosticStatus {
  static constexpr std::string_view kType = "diagnostic_msgs/msg/DiagnosticStatus";
  std::uint8_t level = 0;  // 0 OK, 1 WARN, 2 ERROR, 3 STALE
  std::string name;
  std::string message;
  std::string hardware_id;
  std::vector<KeyValue> values;
  static void visit(auto& self, auto& each) {
    each(self.level, self.name, self.message, self.hardware_id, self.values);
  }
  bool operator==(const DiagnosticStatus&) const = default;
};

struct DiagnosticArray {
  static constexpr std::string_view kType = "diagnostic_msgs/msg/DiagnosticArray";
  static constexpr std::size_t kLargest = kLargestReport;
  Header header;
  std::vector<DiagnosticStatus> status;
  static void visit(auto& self, auto& each) { each(self.header, self.status); }
  bool operator==(const DiagnosticArray&) const = default;
};

struct GoalInfo {
  static constexpr std::string_view kType = "action_msgs/msg/GoalInfo";
  std::array<std::uint8_t, 16> goal_id{};  // unique_identifier_msgs/msg/UUID
  Time stamp;
  static void visit(auto& self, auto& each) { each(self.goal_id, self.stamp); }
  bool operator==(const GoalInfo&) const = default;
};

struct GoalStatus {
  static constexpr std::string_view kType = "action_msgs/msg/GoalStatus";
  GoalInfo goal_info;
  std::int8_t status = 0;
  static void visit(auto& self, auto& each) { each(self.goal_info, self.status); }
  bool operator==(const GoalStatus&) const = default;
};

struct GoalStatusArray {
  static constexpr std::string_view kType = "action_msgs/msg/GoalStatusArray";
  std::vector<GoalStatus> status_list;
  static void visit(auto& self, auto& each) { each(self.status_list); }
  bool operator==(const GoalStatusArray&) const = default;
};

struct Image {
  static constexpr std::string_view kType = "sensor_msgs/msg/Image";
  Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string encoding;
  std::uint8_t is_bigendian = 0;
  std::uint32_t step = 0;  // bytes in a row
  std::vector<std::uint8_t> data;
  static void visit(auto& self, auto& each) {
    each(self.header, self.height, self.width, self.encoding, self.is_bigendian, self.step,
         self.data);
  }
  bool operator==(const Image&) const = default;
};

struct Log {
  static constexpr std::string_view kType = "rcl_interfaces/msg/Log";
  static constexpr std::size_t kLargest = kLargestReport;
  Time stamp;
  std::uint8_t level = 0;
  std::string name;
  std::string msg;
  std::string file;
  std::string function;
  std::uint32_t line = 0;
  static void visit(auto& self, auto& each) {
    each(self.stamp, self.level, self.name, self.msg, self.file, self.function, self.line);
  }
  bool operator==(const Log&) const = default;
};

// The state of a lifecycle node. Ids and labels: lifecycle.h.
struct State {
  static constexpr std::string_view kType = "lifecycle_msgs/msg/State";
  std::uint8_t id = 0;
  std::string label;
  static void visit(auto& self, auto& each) { each(self.id, self.label); }
  bool operator==(const State&) const = default;
};

struct Transition {
  static constexpr std::string_view kType = "lifecycle_msgs/msg/Transition";
  std::uint8_t id = 0;
  std::string label;
  static void visit(auto& self, auto& each) { each(self.id, self.label); }
  bool operator==(const Transition&) const = default;
};

struct TransitionDescription {
  static constexpr std::string_view kType = "lifecycle_msgs/msg/TransitionDescription";
  Transition transition;
  State start_state;
  State goal_state;
  static void visit(auto& self, auto& each) {
    each(self.transition, self.start_state, self.goal_state);
  }
  bool operator==(const TransitionDescription&) const = default;
};

// rclcpp fills in start_state and goal_state only. The sample's source timestamp gives the time.
struct TransitionEvent {
  static constexpr std::string_view kType = "lifecycle_msgs/msg/TransitionEvent";
  std::uint64_t timestamp = 0;
  Transition transition;
  State start_state;
  State goal_state;
  static void visit(auto& self, auto& each) {
    each(self.timestamp, self.transition, self.start_state, self.goal_state);
  }
  bool operator==(const TransitionEvent&) const = default;
};

enum class ParameterType : std::uint8_t {
  kNotSet = 0,
  kBool = 1,
  kInteger = 2,
  kDouble = 3,
  kString = 4,
  kByteArray = 5,
  kBoolArray = 6,
  kIntegerArray = 7,
  kDoubleArray = 8,
  kStringArray = 9
};

// A flat struct on the wire: every member is always there, `type` selects one.
struct ParameterValue {
  static constexpr std::string_view kType = "rcl_interfaces/msg/ParameterValue";
  std::uint8_t type = 0;  // a ParameterType, as far as the sender knows them
  bool bool_value = false;
  std::int64_t integer_value = 0;
  double double_value = 0;
  std::string string_value;
  std::vector<std::uint8_t> byte_array_value;
  std::vector<bool> bool_array_value;
  std::vector<std::int64_t> integer_array_value;
  std::vector<double> double_array_value;
  std::vector<std::string> string_array_value;
  static void visit(auto& self, auto& each) {
    each(self.type, self.bool_value, self.integer_value, self.double_value, self.string_value,
         self.byte_array_value, self.bool_array_value, self.integer_array_value,
         self.double_array_value, self.string_array_value);
  }
  bool operator==(const ParameterValue&) const = default;
};

struct Parameter {
  static constexpr std::string_view kType = "rcl_interfaces/msg/Parameter";
  std::string name;
  ParameterValue value;
  static void visit(auto& self, auto& each) { each(self.name, self.value); }
  bool operator==(const Parameter&) const = default;
};

struct ParameterEvent {
  static constexpr std::string_view kType = "rcl_interfaces/msg/ParameterEvent";
  static constexpr std::size_t kLargest = kLargestReport;
  Time stamp;
  std::string node;  // full name
  std::vector<Parameter> new_parameters;
  std::vector<Parameter> changed_parameters;
  std::vector<Parameter> deleted_parameters;
  static void visit(auto& self, auto& each) {
    each(self.stamp, self.node, self.new_parameters, self.changed_parameters,
         self.deleted_parameters);
  }
  bool operator==(const ParameterEvent&) const = default;
};

struct SetParametersResult {
  static constexpr std::string_view kType = "rcl_interfaces/msg/SetParametersResult";
  bool successful = false;
  std::string reason;  // why not; empty on success
  static void visit(auto& self, auto& each) { each(self.successful, self.reason); }
  bool operator==(const SetParametersResult&) const = default;
};

struct FloatingPointRange {
  static constexpr std::string_view kType = "rcl_interfaces/msg/FloatingPointRange";
  double from_value = 0;
  double to_value = 0;
  double step = 0;  // 0: any value between
  static void visit(auto& self, auto& each) { each(self.from_value, self.to_value, self.step); }
  bool operator==(const FloatingPointRange&) const = default;
};

struct IntegerRange {
  static constexpr std::string_view kType = "rcl_interfaces/msg/IntegerRange";
  std::int64_t from_value = 0;
  std::int64_t to_value = 0;
  std::uint64_t step = 0;  // 0: any value between
  static void visit(auto& self, auto& each) { each(self.from_value, self.to_value, self.step); }
  bool operator==(const IntegerRange&) const = default;
};

struct ParameterDescriptor {
  static constexpr std::string_view kType = "rcl_interfaces/msg/ParameterDescriptor";
  std::string name;
  std::uint8_t type = 0;
  std::string description;
  std::string additional_constraints;
  bool read_only = false;
  bool dynamic_typing = false;
  std::vector<FloatingPointRange> floating_point_range;  // at most one
  std::vector<IntegerRange> integer_range;               // at most one
  static void visit(auto& self, auto& each) {
    each(self.name, self.type, self.description, self.additional_constraints, self.read_only,
         self.dynamic_typing, self.floating_point_range, self.integer_range);
  }
  bool operator==(const ParameterDescriptor&) const = default;
};

// ---- definitions of types, as Jazzy's nodes describe them (type_description_interfaces)

struct FieldType {
  static constexpr std::string_view kType = "type_description_interfaces/msg/FieldType";
  std::uint8_t type_id = 0;           // numbered in type_description.h
  std::uint64_t capacity = 0;         // of an array, or a bounded sequence
  std::uint64_t string_capacity = 0;  // of a bounded string
  std::string nested_type_name;
  static void visit(auto& self, auto& each) {
    each(self.type_id, self.capacity, self.string_capacity, self.nested_type_name);
  }
};

struct Field {
  static constexpr std::string_view kType = "type_description_interfaces/msg/Field";
  std::string name;
  FieldType type;
  std::string default_value;
  static void visit(auto& self, auto& each) { each(self.name, self.type, self.default_value); }
};

struct IndividualTypeDescription {
  static constexpr std::string_view kType =
      "type_description_interfaces/msg/IndividualTypeDescription";
  std::string type_name;
  std::vector<Field> fields;
  static void visit(auto& self, auto& each) { each(self.type_name, self.fields); }
};

struct TypeDescription {
  static constexpr std::string_view kType = "type_description_interfaces/msg/TypeDescription";
  IndividualTypeDescription type_description;
  std::vector<IndividualTypeDescription> referenced_type_descriptions;
  static void visit(auto& self, auto& each) {
    each(self.type_description, self.referenced_type_descriptions);
  }
};

struct TypeSource {
  static constexpr std::string_view kType = "type_description_interfaces/msg/TypeSource";
  std::string type_name;
  std::string encoding;  // "msg", "idl" ...
  std::string raw_file_contents;
  static void visit(auto& self, auto& each) {
    each(self.type_name, self.encoding, self.raw_file_contents);
  }
};

struct TypeDetail {
  static constexpr std::string_view kType = "type_description_interfaces/msg/KeyValue";
  std::string key;
  std::string value;
  static void visit(auto& self, auto& each) { each(self.key, self.value); }
};

}  // namespace culprit::ros2::msg
