#include "ros2/type_description.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>

#include <openssl/sha.h>

#include "base/invariant.h"
#include "ros2/names.h"

namespace culprit::ros2 {
namespace {

constexpr std::string_view kCulpritsMark = "culprit=1;";

// type_description_interfaces/msg/FieldType. An array of a type has its number and 48, a bounded
// sequence 96, an unbounded one 144.
constexpr int kNested = 1;
constexpr int kBoundedText = 4;  // from the number of a string to that of one with a bound
constexpr int kShapeStep = 48;
constexpr std::array<std::pair<Primitive, int>, 14> kNumbers = {{{Primitive::kInt8, 2},
                                                                 {Primitive::kUint8, 3},
                                                                 {Primitive::kInt16, 4},
                                                                 {Primitive::kUint16, 5},
                                                                 {Primitive::kInt32, 6},
                                                                 {Primitive::kUint32, 7},
                                                                 {Primitive::kInt64, 8},
                                                                 {Primitive::kUint64, 9},
                                                                 {Primitive::kFloat32, 10},
                                                                 {Primitive::kFloat64, 11},
                                                                 {Primitive::kBool, 15},
                                                                 {Primitive::kByte, 16},
                                                                 {Primitive::kString, 17},
                                                                 {Primitive::kWString, 18}}};

int number_of(Primitive primitive) {
  if (primitive == Primitive::kChar) primitive = Primitive::kUint8;  // as .msg files have it
  return std::find_if(kNumbers.begin(), kNumbers.end(),
                      [&](const auto& known) { return known.first == primitive; })
      ->second;
}

int steps_of(const FieldDefinition& field) {
  switch (field.shape) {
    case Shape::kSingle:
      return 0;
    case Shape::kArray:
      return 1;
    case Shape::kSequence:
      return field.count == 0 ? 3 : 2;
  }
  return 0;
}

msg::Field describe(const FieldDefinition& field) {
  const auto* primitive = std::get_if<Primitive>(&field.element);
  const int number = primitive != nullptr ? number_of(*primitive) : kNested;
  const int bounded = field.text_bound == 0 ? 0 : kBoundedText;
  return {field.name,
          {static_cast<std::uint8_t>(number + bounded + steps_of(field) * kShapeStep),
           field.shape == Shape::kSingle ? 0 : field.count, field.text_bound,
           primitive != nullptr ? "" : std::get<std::string>(field.element)},
          {}};
}

// The field that a message without fields has on the wire and in its description.
const FieldDefinition kFiller{.name = "structure_needs_at_least_one_member",
                              .element = Primitive::kUint8};

msg::IndividualTypeDescription describe(const MessageDefinition& definition) {
  msg::IndividualTypeDescription out{definition.type, {}};
  for (const FieldDefinition& field : definition.fields) out.fields.push_back(describe(field));
  if (out.fields.empty()) out.fields.push_back(describe(kFiller));
  return out;
}

Expected<FieldDefinition> to_definition(const msg::Field& field) {
  const auto objection = [&](const std::string& what) {
    return Error{"its field '" + printable(field.name) + "' " + what};
  };
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  const msg::FieldType& type = field.type;
  const int steps = type.type_id / kShapeStep;
  int number = type.type_id % kShapeStep;
  const bool has_text_bound = number == 21 || number == 22;
  if (has_text_bound) number -= kBoundedText;
  const bool has_count = steps == 1 || steps == 2;
  if (!is_valid_node_name(field.name)) return objection("cannot be called so");
  if (steps > 3) return objection("is of no known kind");
  if (has_count && (type.capacity == 0 || type.capacity > kMost))
    return objection("has an impossible size");
  if (has_text_bound && (type.string_capacity == 0 || type.string_capacity > kMost))
    return objection("has an impossible bound");
  FieldDefinition out{.name = field.name, .element = Primitive::kUint8};
  out.shape = steps == 0 ? Shape::kSingle : steps == 1 ? Shape::kArray : Shape::kSequence;
  out.count = has_count ? static_cast<std::uint32_t>(type.capacity) : steps == 0 ? 1 : 0;
  out.text_bound = has_text_bound ? static_cast<std::uint32_t>(type.string_capacity) : 0;
  if (number == kNested) {
    if (!is_valid_type_name(type.nested_type_name)) return objection("is of no valid type");
    out.element = type.nested_type_name;
    return out;
  }
  const auto known = std::find_if(kNumbers.begin(), kNumbers.end(),
                                  [&](const auto& k) { return k.second == number; });
  if (known == kNumbers.end()) return objection("is of a type that no ROS message has");
  out.element = known->first;
  return out;
}

Expected<MessageDefinition> to_definition(const msg::IndividualTypeDescription& description) {
  if (!is_valid_type_name(description.type_name))
    return Error{"'" + printable(description.type_name) + "' is not the name of a type"};
  MessageDefinition out{description.type_name, {}};
  for (const msg::Field& field : description.fields) {
    auto definition = to_definition(field);
    if (!definition) return Error{description.type_name + ": " + definition.error()};
    out.fields.push_back(std::move(*definition));
  }
  if (out.fields.size() == 1 && out.fields.front() == kFiller) out.fields.clear();
  return out;
}

// Names of types and fields hold letters, digits, '_' and '/' only: nothing has to be escaped.
std::string json_text(std::string_view text) { return '"' + std::string(text) + '"'; }

std::string to_json(const msg::IndividualTypeDescription& description) {
  std::string fields;
  for (const msg::Field& field : description.fields) {
    fields += (fields.empty() ? "" : ", ") + ("{\"name\": " + json_text(field.name)) +
              ", \"type\": {\"type_id\": " + std::to_string(field.type.type_id) +
              ", \"capacity\": " + std::to_string(field.type.capacity) +
              ", \"string_capacity\": " + std::to_string(field.type.string_capacity) +
              ", \"nested_type_name\": " + json_text(field.type.nested_type_name) + "}}";
  }
  return "{\"type_name\": " + json_text(description.type_name) + ", \"fields\": [" + fields + "]}";
}

}  // namespace

msg::TypeDescription describe(std::string_view type, const MessageDefinitions& definitions) {
  const auto described = definitions.find(type);
  CULPRIT_ASSERT(described != definitions.end());
  msg::TypeDescription out{describe(described->second), {}};
  for (const auto& [name, part] : definitions) {
    if (name != type) out.referenced_type_descriptions.push_back(describe(part));
  }
  return out;
}

Expected<MessageDefinitions> to_definitions(const msg::TypeDescription& description) {
  MessageDefinitions out;
  std::vector<const msg::IndividualTypeDescription*> all = {&description.type_description};
  for (const auto& part : description.referenced_type_descriptions) all.push_back(&part);
  for (const auto* each : all) {
    auto definition = to_definition(*each);
    if (!definition) return Error{definition.error()};
    out.emplace(each->type_name, std::move(*definition));
  }
  return out;
}

std::string type_user_data(std::string_view hash, std::string_view service_hash) {
  std::string text;
  if (!hash.empty()) text.append("typehash=").append(hash).append(";");
  if (!service_hash.empty()) text.append("sertypehash=").append(service_hash).append(";");
  return text.append(kCulpritsMark);
}

bool is_of_culprit(std::string_view user_data) {
  return user_data.find(kCulpritsMark) != std::string_view::npos;
}

std::string type_hash(std::string_view type, const MessageDefinitions& definitions) {
  const msg::TypeDescription description = describe(type, definitions);
  std::string referenced;
  for (const auto& part : description.referenced_type_descriptions)
    referenced += (referenced.empty() ? "" : ", ") + to_json(part);
  const std::string json = "{\"type_description\": " + to_json(description.type_description) +
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
