#include "ros2/message_definition.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <set>
#include <utility>

#include "base/invariant.h"
#include "ros2/names.h"

namespace culprit::ros2 {
namespace {

constexpr std::array<std::pair<std::string_view, Primitive>, 15> kPrimitives = {{
    {"bool", Primitive::kBool},
    {"byte", Primitive::kByte},
    {"char", Primitive::kChar},
    {"int8", Primitive::kInt8},
    {"uint8", Primitive::kUint8},
    {"int16", Primitive::kInt16},
    {"uint16", Primitive::kUint16},
    {"int32", Primitive::kInt32},
    {"uint32", Primitive::kUint32},
    {"int64", Primitive::kInt64},
    {"uint64", Primitive::kUint64},
    {"float32", Primitive::kFloat32},
    {"float64", Primitive::kFloat64},
    {"string", Primitive::kString},
    {"wstring", Primitive::kWString},
}};

constexpr std::string_view kBlanks = " \t\r";

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

// Takes the first word off `text`, and the blanks after it.
std::string_view take_word(std::string_view& text) {
  const auto end = std::min(text.find_first_of(kBlanks), text.size());
  const auto word = text.substr(0, end);
  text = trimmed(text.substr(end));
  return word;
}

bool is_identifier(std::string_view text) {
  return is_valid_node_name(
      text);  // the same grammar: letters, digits, underscores, no digit first
}

// > 0 and in range, or nothing.
std::optional<std::uint32_t> parse_size(std::string_view text) {
  std::uint32_t size = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, size);
  if (error != std::errc() || rest != end || size == 0) return std::nullopt;
  return size;
}

std::optional<Primitive> find_primitive(std::string_view name) {
  for (const auto& [known, primitive] : kPrimitives) {
    if (known == name) return primitive;
  }
  return std::nullopt;
}

class Parser {
 public:
  Parser(std::string_view type, std::string_view file)
      : definition_{std::string(type), {}}, package_(type.substr(0, type.find('/'))), file_(file) {}

  Expected<MessageDefinition> parse(std::string_view text) {
    while (!text.empty()) {
      ++line_;
      const auto end = std::min(text.find('\n'), text.size());
      if (auto parsed = parse_line(text.substr(0, end)); !parsed) return Error{parsed.error()};
      text.remove_prefix(std::min(end + 1, text.size()));
    }
    return std::move(definition_);
  }

 private:
  Error error(std::string what) const {
    return Error{std::string(file_) + ":" + std::to_string(line_) + ": " + std::move(what)};
  }

  // <type> <field> [<default>]  |  <type> <CONSTANT>=<value>  |  nothing; then perhaps a comment
  Expected<void> parse_line(std::string_view line) {
    std::string_view rest = trimmed(line);
    if (rest.empty() || rest.starts_with('#')) return {};

    FieldDefinition field;
    const std::string_view type = take_word(rest);
    if (auto parsed = parse_type(type, field); !parsed) return parsed;

    const std::string_view name = rest.substr(0, rest.find_first_of(" \t=#"));
    const std::string_view after = trimmed(rest.substr(name.size()));
    if (name.empty())
      return error("'" + printable(type) + "' is not followed by the name of a field");
    if (!is_identifier(name))
      return error("'" + printable(name) + "' cannot be the name of a field");
    if (after.starts_with('=')) return parse_constant(field, name, trimmed(after.substr(1)));

    if (!names_.emplace(name).second) {
      return error("there are two fields with the name '" + printable(name) + "'");
    }
    field.name = name;
    definition_.fields.push_back(std::move(field));
    return parse_default(after);
  }

  Expected<void> parse_constant(const FieldDefinition& field, std::string_view name,
                                std::string_view value) const {
    const bool is_primitive = std::holds_alternative<Primitive>(field.element);
    if (!is_primitive || field.shape != Shape::kSingle) {
      return error("the constant '" + printable(name) + "' is not of a primitive type");
    }
    // An unquoted string may be empty, and may hold a '#': there is nothing to check in it.
    const bool is_text = std::get<Primitive>(field.element) >= Primitive::kString;
    if (!is_text && (value.empty() || value.starts_with('#'))) {
      return error("the constant '" + printable(name) + "' has no value");
    }
    return {};
  }

  // A bracket or quote that opens must close; the value itself is never sent.
  Expected<void> parse_default(std::string_view value) const {
    if (value.empty() || value.starts_with('#')) return {};
    const char first = value.front();
    const char last = first == '[' ? ']' : first;
    const bool is_enclosed = first == '[' || first == '"' || first == '\'';
    if (is_enclosed && value.find(last, 1) == std::string_view::npos) {
      return error(std::string("the default value opens with ") + first + " and does not close");
    }
    return {};
  }

  Expected<void> parse_type(std::string_view text, FieldDefinition& field) const {
    if (text.ends_with(']')) {
      const auto open = text.rfind('[');
      if (open == std::string_view::npos) return error("'" + printable(text) + "' lacks a '['");
      std::string_view size = text.substr(open + 1, text.size() - open - 2);
      const bool is_bound = size.starts_with("<=");
      if (is_bound) size.remove_prefix(2);
      field.shape = size.empty() || is_bound ? Shape::kSequence : Shape::kArray;
      if (is_bound || !size.empty()) {
        const auto count = parse_size(size);
        if (!count) return error("'" + printable(size) + "' is not the size of an array");
        field.count = *count;
      } else {
        field.count = 0;
      }
      text = text.substr(0, open);
    }
    if (const auto bound = text.find("<="); bound != std::string_view::npos) {
      const auto element = text.substr(0, bound);
      if (element != "string" && element != "wstring") {
        return error("only strings have a bound, not '" + printable(element) + "'");
      }
      const auto size = parse_size(text.substr(bound + 2));
      if (!size) {
        return error("'" + printable(text.substr(bound + 2)) + "' is not the size of a string");
      }
      field.text_bound = *size;
      text = element;
    }
    if (const auto primitive = find_primitive(text)) {
      field.element = *primitive;
      return {};
    }
    return parse_message_type(text, field);
  }

  Expected<void> parse_message_type(std::string_view text, FieldDefinition& field) const {
    std::string type;
    const auto slash = text.find('/');
    if (text == "Header") {
      type = "std_msgs/msg/Header";  // as ROS 1 had it, and many files still do
    } else if (slash == std::string_view::npos) {
      type = std::string(package_) + "/msg/" + std::string(text);
    } else if (text.find('/', slash + 1) == std::string_view::npos) {
      type = std::string(text.substr(0, slash)) + "/msg" + std::string(text.substr(slash));
    } else {
      type = text;
    }
    if (!is_valid_type_name(type))
      return error("'" + printable(text) + "' is not the name of a type");
    field.element = std::move(type);
    return {};
  }

  MessageDefinition definition_;
  std::string package_;
  std::string_view file_;
  std::set<std::string, std::less<>> names_;
  int line_ = 0;
};

std::string to_text(const FieldDefinition& field) {
  std::string text;
  if (const auto* primitive = std::get_if<Primitive>(&field.element)) {
    text = std::find_if(kPrimitives.begin(), kPrimitives.end(), [&](const auto& known) {
             return known.second == *primitive;
           })->first;
  } else {
    text = std::get<std::string>(field.element);
  }
  if (field.text_bound != 0) text += "<=" + std::to_string(field.text_bound);
  const std::string count = std::to_string(field.count);
  if (field.shape == Shape::kArray) text += "[" + count + "]";
  if (field.shape == Shape::kSequence) text += field.count == 0 ? "[]" : "[<=" + count + "]";
  return text + " " + field.name + "\n";
}

}  // namespace

Expected<MessageDefinition> parse_message_definition(std::string_view text, std::string_view type,
                                                     std::string_view file) {
  return Parser(type, file).parse(text);
}

std::string to_text(std::string_view type, const MessageDefinitions& definitions) {
  const auto fields_of = [](const MessageDefinition& definition) {
    std::string text;
    for (const FieldDefinition& field : definition.fields) text += to_text(field);
    return text;
  };
  const auto described = definitions.find(type);
  CULPRIT_ASSERT(described != definitions.end());
  std::string text = fields_of(described->second);
  for (const auto& [name, part] : definitions) {
    if (name != type) text += std::string(80, '=') + "\nMSG: " + name + "\n" + fields_of(part);
  }
  return text;
}

}  // namespace culprit::ros2
