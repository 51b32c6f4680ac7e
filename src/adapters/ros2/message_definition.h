// The definition of a message type, read from the text of its `.msg` file
// (design.ros2.org/articles/legacy_interface_definition.html).
//
// It keeps what the wire needs: the fields in order with their types, and the bounds, which are
// part of a type's identity (type_description.h). Constants, default values and comments are
// checked for form and dropped, for they are never sent.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/expected.h"

namespace culprit::ros2 {

enum class Primitive : std::uint8_t {
  kBool,
  kByte,
  kChar,
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64,
  kString,
  kWString
};

enum class Shape : std::uint8_t {
  kSingle,
  kArray,    // `count` elements, bare
  kSequence  // a count, then so many elements; bounded or not, it looks the same
};

struct FieldDefinition {
  std::string name;
  std::variant<Primitive, std::string>
      element;  // or the full name of a message, "package/msg/Type"
  Shape shape = Shape::kSingle;
  std::uint32_t count = 1;       // of a kArray; the bound of a kSequence, 0 if it has none
  std::uint32_t text_bound = 0;  // of a string: so many characters at most; 0: any

  bool operator==(const FieldDefinition&) const = default;
};

struct MessageDefinition {
  std::string type;  // "package/msg/Type"
  std::vector<FieldDefinition> fields;

  bool operator==(const MessageDefinition&) const = default;
};

// `text` defines `type`, a valid "package/msg/Type". Errors begin with "<file>:<line>: ".
Expected<MessageDefinition> parse_message_definition(std::string_view text, std::string_view type,
                                                     std::string_view file);

using MessageDefinitions = std::map<std::string, MessageDefinition, std::less<>>;  // by type

// The text of `type`'s file and of those of all types in it, as MessageLibrary::learn() takes it.
// @pre `type` is among the definitions
std::string to_text(std::string_view type, const MessageDefinitions& definitions);

}  // namespace culprit::ros2
