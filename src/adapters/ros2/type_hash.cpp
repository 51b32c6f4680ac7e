#include "ros2/type_hash.h"

#include <array>
#include <cassert>
#include <cstdint>

#include <openssl/sha.h>

namespace culprit::ros2 {
namespace {

// type_description_interfaces/msg/FieldType. An array of a type has its number and 48, a bounded
// sequence 96, an unbounded one 144.
constexpr int kNested = 1;
constexpr int kArrayOf = 48;
constexpr int kBoundedSequenceOf = 96;
constexpr int kSequenceOf = 144;
constexpr int kBoundedText = 4;  // from a string to one with a bound

int number_of(Primitive primitive) {
  switch (primitive) {
    case Primitive::kBool:
      return 15;
    case Primitive::kByte:
      return 16;
    case Primitive::kChar:
      return 3;  // what a .msg file calls so is a uint8
    case Primitive::kInt8:
      return 2;
    case Primitive::kUint8:
      return 3;
    case Primitive::kInt16:
      return 4;
    case Primitive::kUint16:
      return 5;
    case Primitive::kInt32:
      return 6;
    case Primitive::kUint32:
      return 7;
    case Primitive::kInt64:
      return 8;
    case Primitive::kUint64:
      return 9;
    case Primitive::kFloat32:
      return 10;
    case Primitive::kFloat64:
      return 11;
    case Primitive::kString:
      return 17;
    case Primitive::kWString:
      return 18;
  }
  return 0;
}

int shape_number(const FieldDefinition& field) {
  switch (field.shape) {
    case Shape::kSingle:
      return 0;
    case Shape::kArray:
      return kArrayOf;
    case Shape::kSequence:
      return field.count == 0 ? kSequenceOf : kBoundedSequenceOf;
  }
  return 0;
}

// Names of types and fields hold letters, digits, '_' and '/' only: nothing has to be escaped.
std::string quoted(std::string_view text) { return '"' + std::string(text) + '"'; }

std::string field_json(const FieldDefinition& field) {
  const auto* primitive = std::get_if<Primitive>(&field.element);
  int number = primitive != nullptr ? number_of(*primitive) : kNested;
  if (field.text_bound != 0) number += kBoundedText;
  const std::uint32_t capacity = field.shape == Shape::kSingle ? 0 : field.count;
  const std::string nested = primitive != nullptr ? "" : std::get<std::string>(field.element);
  return "{\"name\": " + quoted(field.name) +
         ", \"type\": {\"type_id\": " + std::to_string(number + shape_number(field)) +
         ", \"capacity\": " + std::to_string(capacity) +
         ", \"string_capacity\": " + std::to_string(field.text_bound) +
         ", \"nested_type_name\": " + quoted(nested) + "}}";
}

std::string type_json(const MessageDefinition& type) {
  // A message without fields has one on the wire, and in its description.
  static const FieldDefinition kFiller{.name = "structure_needs_at_least_one_member",
                                       .element = Primitive::kUint8};
  std::string fields = type.fields.empty() ? field_json(kFiller) : "";
  for (const FieldDefinition& field : type.fields)
    fields += (fields.empty() ? "" : ", ") + field_json(field);
  return "{\"type_name\": " + quoted(type.type) + ", \"fields\": [" + fields + "]}";
}

}  // namespace

std::string type_hash(std::string_view type, const MessageDefinitions& definitions) {
  const auto described = definitions.find(type);
  assert(described != definitions.end());
  std::string referenced;
  for (const auto& [name, part] : definitions) {
    if (name != type) referenced += (referenced.empty() ? "" : ", ") + type_json(part);
  }
  const std::string json = "{\"type_description\": " + type_json(described->second) +
                           ", \"referenced_type_descriptions\": [" + referenced + "]}";
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest{};
  SHA256(reinterpret_cast<const unsigned char*>(json.data()), json.size(), digest.data());
  std::string hash = "RIHS01_";
  constexpr std::string_view kDigits = "0123456789abcdef";
  for (const unsigned char byte : digest) {
    hash += kDigits[byte >> 4];
    hash += kDigits[byte & 15];
  }
  return hash;
}

}  // namespace culprit::ros2
