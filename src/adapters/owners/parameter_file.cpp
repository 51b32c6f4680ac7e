#include "owners/parameter_file.h"

#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>

#include <yaml-cpp/yaml.h>

#include "ros2/names.h"

namespace culprit::owners {
namespace {

using ros2::msg::ParameterType;
using ros2::msg::ParameterValue;
using Parameters = std::map<std::string, ParameterValue>;

constexpr std::size_t kLongestFile = 1 << 20;  // bytes
constexpr int kDeepest = 16;
constexpr std::size_t kMost = 10'000;                      // parameters
constexpr std::size_t kMostBytes = std::size_t{16} << 20;  // with aliases and names in full
constexpr const char* kParameters = "ros__parameters";

struct WrongFile : std::runtime_error {
  WrongFile(const YAML::Mark& at, const std::string& what) : std::runtime_error(what), mark(at) {}
  YAML::Mark mark;
};

std::vector<std::string> split_name(const std::string& name) {
  std::vector<std::string> tokens;
  std::istringstream in(name);
  for (std::string token; std::getline(in, token, '/');) {
    if (!token.empty()) tokens.push_back(token);
  }
  return tokens;
}

// "*" stands for one token, "**" for any number. Takes time in proportion to both lengths, whatever the
// pattern.
bool matches(const std::vector<std::string>& pattern, const std::vector<std::string>& name) {
  std::vector<bool> is_matched(name.size() + 1);  // the first i tokens, by the pattern so far
  is_matched[0] = true;
  for (const std::string& token : pattern) {
    if (token == "**") {
      for (std::size_t i = 1; i <= name.size(); ++i)
        is_matched[i] = is_matched[i] || is_matched[i - 1];
      continue;
    }
    for (std::size_t i = name.size(); i > 0; --i)
      is_matched[i] = is_matched[i - 1] && (token == "*" || token == name[i - 1]);
    is_matched[0] = false;
  }
  return is_matched.back();
}

std::optional<bool> truth(const std::string& text) {
  static const std::set<std::string> kTrue{"true", "True", "TRUE", "yes", "Yes", "YES",
                                           "on",   "On",   "ON",   "y",   "Y"};
  static const std::set<std::string> kFalse{"false", "False", "FALSE", "no", "No", "NO",
                                            "off",   "Off",   "OFF",   "n",  "N"};
  if (kTrue.contains(text)) return true;
  if (kFalse.contains(text)) return false;
  return std::nullopt;
}

// As rcl reads it: "0x29" is hexadecimal, and "010" is 8.
std::optional<std::int64_t> whole_in(const std::string& text) {
  const bool begins = !text.empty() && std::isspace(static_cast<unsigned char>(text[0])) == 0;
  char* last = nullptr;
  errno = 0;
  const std::int64_t value = std::strtoll(text.c_str(), &last, 0);
  if (!begins || errno != 0 || last != text.c_str() + text.size()) return std::nullopt;
  return value;
}

std::optional<double> real_in(const std::string& text) {
  if (text == ".inf" || text == "+.inf") return std::numeric_limits<double>::infinity();
  if (text == "-.inf") return -std::numeric_limits<double>::infinity();
  if (text == ".nan") return std::numeric_limits<double>::quiet_NaN();
  if (text.find_first_of("0123456789") == std::string::npos) return std::nullopt;
  const bool has_plus = text.starts_with('+');
  const char* end = text.data() + text.size();
  double value{};
  const auto [last, error] = std::from_chars(text.data() + (has_plus ? 1 : 0), end, value);
  if (error != std::errc() || last != end) return std::nullopt;
  return value;
}

ParameterValue scalar(const YAML::Node& node) {
  const std::string& text = node.Scalar();
  ParameterValue value;
  const bool is_quoted =
      node.Tag() == "!" || node.Tag() == "tag:yaml.org,2002:str" || node.Tag() == "!!str";
  if (!is_quoted) {
    if (const auto is = truth(text)) {
      value.type = static_cast<std::uint8_t>(ParameterType::kBool);
      value.bool_value = *is;
      return value;
    }
    if (const auto whole = whole_in(text)) {
      value.type = static_cast<std::uint8_t>(ParameterType::kInteger);
      value.integer_value = *whole;
      return value;
    }
    if (const auto real = real_in(text)) {
      value.type = static_cast<std::uint8_t>(ParameterType::kDouble);
      value.double_value = *real;
      return value;
    }
  }
  value.type = static_cast<std::uint8_t>(ParameterType::kString);
  value.string_value = text;
  return value;
}

// All of one type; only whole numbers may be among others.
ParameterValue list_value(const YAML::Node& node) {
  ParameterValue value;
  std::set<ParameterType> types;
  std::vector<ParameterValue> all;
  for (const auto& each : node) {
    if (!each.IsScalar()) throw WrongFile(each.Mark(), "a list holds values only");
    all.push_back(scalar(each));
    types.insert(static_cast<ParameterType>(all.back().type));
  }
  const bool is_real = types == std::set{ParameterType::kInteger, ParameterType::kDouble} ||
                       types == std::set{ParameterType::kDouble};
  if (types.size() > 1 && !is_real) throw WrongFile(node.Mark(), "a list holds values of one type");
  // As rcl has it: values without a type are text.
  ParameterType type = ParameterType::kStringArray;
  for (const ParameterValue& each : all) {
    const auto of = static_cast<ParameterType>(each.type);
    if (is_real) {
      type = ParameterType::kDoubleArray;
      value.double_array_value.push_back(of == ParameterType::kInteger
                                             ? static_cast<double>(each.integer_value)
                                             : each.double_value);
    } else if (of == ParameterType::kBool) {
      type = ParameterType::kBoolArray;
      value.bool_array_value.push_back(each.bool_value);
    } else if (of == ParameterType::kInteger) {
      type = ParameterType::kIntegerArray;
      value.integer_array_value.push_back(each.integer_value);
    } else {
      value.string_array_value.push_back(each.string_value);
    }
  }
  value.type = static_cast<std::uint8_t>(type);
  return value;
}

struct Found {
  Parameters parameters;
  std::size_t bytes = 0;  // of all that was read

  void count(const YAML::Node& node, const std::string& name) {
    bytes += 1 + name.size() + (node.IsScalar() ? node.Scalar().size() : 0);
    if (bytes > kMostBytes)
      throw WrongFile(node.Mark(), "in full, this file is larger than 16 MiB");
  }
};

void take_values(const YAML::Node& node, const std::string& name, int depth, Found& into) {
  into.count(node, name);
  if (depth > kDeepest || into.parameters.size() > kMost)
    throw WrongFile(node.Mark(), "these are more parameters, or deeper, than a node has");
  if (node.IsMap()) {
    for (const auto& entry : node) {
      if (!entry.first.IsScalar()) throw WrongFile(entry.first.Mark(), "this is no name");
      const std::string& key = entry.first.Scalar();
      take_values(entry.second, name.empty() ? key : name + "." + key, depth + 1, into);
    }
  } else if (name.empty() || node.IsNull()) {
    throw WrongFile(node.Mark(),
                    name.empty() ? "parameters are a mapping" : name + " has no value");
  } else {
    for (std::size_t i = 0; node.IsSequence() && i < node.size(); ++i) into.count(node[i], "");
    into.parameters[name] = node.IsSequence() ? list_value(node) : scalar(node);
  }
}

// Names of nodes and of namespaces, one in the other.
void take_nodes(const YAML::Node& node, const std::string& pattern,
                const std::vector<std::string>& wanted, int depth, Found& into) {
  into.count(node, pattern);
  if (!node.IsMap() || depth > kDeepest)
    throw WrongFile(node.Mark(),
                    "expected the names of nodes, and below them " + std::string(kParameters));
  for (const auto& entry : node) {
    if (!entry.first.IsScalar()) throw WrongFile(entry.first.Mark(), "this is no name");
    const std::string& key = entry.first.Scalar();
    if (key != kParameters) {
      take_nodes(entry.second, pattern + "/" + key, wanted, depth + 1, into);
      continue;
    }
    if (matches(split_name(pattern), wanted)) take_values(entry.second, "", depth + 1, into);
  }
}

std::string number_text(double value) {
  std::array<char, 32> digits{};
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  return {digits.data(), end};
}

template <class Values, class Text>
std::string list_text(const Values& values, Text text) {
  std::string all = "[";
  for (const auto& each : values) all += (all.size() == 1 ? "" : ", ") + text(each);
  return all + "]";
}

}  // namespace

std::string to_yaml(const ParameterValue& value) {
  const auto as_number = [](auto number) { return std::to_string(number); };
  const auto as_bool = [](bool is) { return std::string(is ? "true" : "false"); };
  const auto as_text = [](const std::string& text) { return text; };
  switch (static_cast<ParameterType>(value.type)) {
    case ParameterType::kBool:
      return as_bool(value.bool_value);
    case ParameterType::kInteger:
      return as_number(value.integer_value);
    case ParameterType::kDouble:
      return number_text(value.double_value);
    case ParameterType::kString:
      return value.string_value;
    case ParameterType::kByteArray:
      return list_text(value.byte_array_value, as_number);
    case ParameterType::kBoolArray:
      return list_text(value.bool_array_value, as_bool);
    case ParameterType::kIntegerArray:
      return list_text(value.integer_array_value, as_number);
    case ParameterType::kDoubleArray:
      return list_text(value.double_array_value, number_text);
    case ParameterType::kStringArray:
      return list_text(value.string_array_value, as_text);
    case ParameterType::kNotSet:
      break;
  }
  return "";
}

Expected<ParameterValue> parse_parameter_value(const std::string& text) {
  try {
    const YAML::Node node = YAML::Load(text);
    if (node.IsSequence()) return list_value(node);
    if (node.IsScalar()) return scalar(node);
  } catch (const WrongFile& wrong) {
    return Error{wrong.what()};
  } catch (const YAML::Exception& wrong) {
    return Error{wrong.msg};
  }
  return Error{"a parameter is a value, or a list of values"};
}

Expected<std::vector<ros2::msg::Parameter>> read_parameter_file(const std::string& path,
                                                                const std::string& node) {
  std::error_code error;
  const bool is_file = std::filesystem::is_regular_file(path, error);
  if (!is_file)
    return Error{
        "PARAMETERS: there is no file " + path +
        (error && error != std::errc::no_such_file_or_directory ? ": " + error.message() : "")};
  if (std::filesystem::file_size(path, error) > kLongestFile)
    return Error{"PARAMETERS: " + path + " is longer than a file of parameters is"};
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) return Error{"PARAMETERS: cannot read " + path};
  try {
    Found found;
    take_nodes(YAML::Load(text.str()), "", split_name(node), 0, found);
    std::vector<ros2::msg::Parameter> parameters;
    for (auto& [name, value] : found.parameters) parameters.push_back({name, std::move(value)});
    return parameters;
  } catch (const WrongFile& wrong) {
    return Error{"PARAMETERS: " + path + ":" + std::to_string(wrong.mark.line + 1) + ": " +
                 wrong.what()};
  } catch (const YAML::Exception& wrong) {
    return Error{"PARAMETERS: " + path + ":" + std::to_string(wrong.mark.line + 1) + ": " +
                 wrong.msg};
  }
}

}  // namespace culprit::owners
