#include "ros2/parameter_store.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace culprit::ros2 {
namespace {

using msg::ParameterType;

constexpr char kSeparator = '.';

// As rclcpp names types in its reasons.
std::string_view type_name(std::uint8_t type) {
  constexpr std::array<std::string_view, 10> kNames = {
      "not set",    "bool",       "integer",       "double",       "string",
      "byte_array", "bool_array", "integer_array", "double_array", "string_array"};
  return type < kNames.size() ? kNames[type] : "unknown";
}

bool is_close(double a, double b) {
  return std::abs(a - b) <= std::numeric_limits<double>::epsilon() * std::abs(a + b) * 100;
}

bool is_in_range(const msg::FloatingPointRange& range, double value) {
  if (is_close(value, range.from_value) || is_close(value, range.to_value)) return true;
  if (!(value > range.from_value && value < range.to_value)) return false;  // also NaN
  if (range.step == 0) return true;
  const double steps = std::round((value - range.from_value) / range.step);
  return is_close(value, range.from_value + steps * range.step);
}

bool is_in_range(const msg::IntegerRange& range, std::int64_t value) {
  if (value == range.from_value || value == range.to_value) return true;
  if (value < range.from_value || value > range.to_value) return false;
  // Unsigned: the distance may exceed what an int64 holds.
  const std::uint64_t distance =
      static_cast<std::uint64_t>(value) - static_cast<std::uint64_t>(range.from_value);
  return range.step == 0 || distance % range.step == 0;
}

Expected<void> check_range(const msg::ParameterDescriptor& descriptor,
                           const msg::ParameterValue& value) {
  const bool is_integer = value.type == static_cast<std::uint8_t>(ParameterType::kInteger);
  const bool is_double = value.type == static_cast<std::uint8_t>(ParameterType::kDouble);
  if (is_integer && !descriptor.integer_range.empty() &&
      !is_in_range(descriptor.integer_range.front(), value.integer_value)) {
    return Error{"Parameter {" + descriptor.name + "} doesn't comply with integer range."};
  }
  if (is_double && !descriptor.floating_point_range.empty() &&
      !is_in_range(descriptor.floating_point_range.front(), value.double_value)) {
    return Error{"Parameter {" + descriptor.name + "} doesn't comply with floating point range."};
  }
  return {};
}

}  // namespace

std::optional<Value> to_value(const msg::ParameterValue& value) {
  switch (static_cast<ParameterType>(value.type)) {
    case ParameterType::kBool:
      return value.bool_value;
    case ParameterType::kInteger:
      return value.integer_value;
    case ParameterType::kDouble:
      return value.double_value;
    case ParameterType::kString:
      return value.string_value;
    default:
      return std::nullopt;  // what a stranger sent need not be one of ours
  }
}

msg::ParameterValue to_parameter_value(const Value& value) {
  msg::ParameterValue out;
  ParameterType type = ParameterType::kString;
  if (const auto* b = std::get_if<bool>(&value)) {
    type = ParameterType::kBool;
    out.bool_value = *b;
  } else if (const auto* i = std::get_if<std::int64_t>(&value)) {
    type = ParameterType::kInteger;
    out.integer_value = *i;
  } else if (const auto* d = std::get_if<double>(&value)) {
    type = ParameterType::kDouble;
    out.double_value = *d;
  } else {
    out.string_value = std::get<std::string>(value);
  }
  out.type = static_cast<std::uint8_t>(type);
  return out;
}

ParameterStore::ParameterStore(std::string node, OnEvent on_event)
    : node_(std::move(node)), on_event_(std::move(on_event)) {}

Expected<void> ParameterStore::declare(const std::string& name, msg::ParameterValue value,
                                       msg::ParameterDescriptor descriptor) {
  if (name.empty()) return Error{"parameter name must not be empty"};
  if (entries_.contains(name)) return Error{"parameter '" + name + "' has already been declared"};
  if (value.type == static_cast<std::uint8_t>(ParameterType::kNotSet)) {
    return Error{"parameter '" + name + "' cannot be declared without a value"};
  }
  descriptor.name = name;
  descriptor.type = value.type;
  if (auto checked = check_range(descriptor, value); !checked) return checked;
  const std::array parameter = {msg::Parameter{name, value}};
  if (auto agreed = ask_callbacks(parameter); !agreed) return agreed;

  entries_.emplace(name, Entry{std::move(value), std::move(descriptor)});
  tell({.stamp = {},
        .node = node_,
        .new_parameters = {parameter.begin(), parameter.end()},
        .changed_parameters = {},
        .deleted_parameters = {}});
  return {};
}

Expected<void> ParameterStore::declare(const std::string& name, const Value& value,
                                       msg::ParameterDescriptor descriptor) {
  return declare(name, to_parameter_value(value), std::move(descriptor));
}

msg::SetParametersResult ParameterStore::set(std::span<const msg::Parameter> parameters) {
  for (const msg::Parameter& parameter : parameters) {
    if (auto checked = check(parameter); !checked) return {false, checked.error()};
  }
  if (auto agreed = ask_callbacks(parameters); !agreed) return {false, agreed.error()};
  for (const msg::Parameter& parameter : parameters)
    entries_.find(parameter.name)->second.value = parameter.value;
  tell({.stamp = {},
        .node = node_,
        .new_parameters = {},
        .changed_parameters = {parameters.begin(), parameters.end()},
        .deleted_parameters = {}});
  return {true, ""};
}

// The wording is rclcpp's: scripts and people know it.
Expected<void> ParameterStore::check(const msg::Parameter& parameter) const {
  const std::string& name = parameter.name;
  const auto found = entries_.find(name);
  if (found == entries_.end()) {
    return Error{"parameter '" + name + "' cannot be set because it was not declared"};
  }
  const msg::ParameterDescriptor& descriptor = found->second.descriptor;
  if (descriptor.read_only)
    return Error{"parameter '" + name + "' cannot be set because it is read-only"};
  if (parameter.value.type == static_cast<std::uint8_t>(ParameterType::kNotSet)) {
    return Error{"cannot undeclare an statically typed parameter"};
  }
  if (parameter.value.type != descriptor.type) {
    return Error{"Wrong parameter type, parameter {" + name + "} is of type {" +
                 std::string(type_name(descriptor.type)) + "}, setting it to {" +
                 std::string(type_name(parameter.value.type)) + "} is not allowed."};
  }
  return check_range(descriptor, parameter.value);
}

Expected<void> ParameterStore::ask_callbacks(std::span<const msg::Parameter> parameters) const {
  for (const OnSet& callback : callbacks_) {
    if (auto agreed = callback(parameters); !agreed) return agreed;
  }
  return {};
}

void ParameterStore::tell(msg::ParameterEvent event) const {
  if (on_event_) on_event_(std::move(event));
}

const msg::ParameterValue* ParameterStore::find(std::string_view name) const {
  const auto found = entries_.find(name);
  return found == entries_.end() ? nullptr : &found->second.value;
}

bool ParameterStore::knows_all(std::span<const std::string> names) const {
  return std::ranges::all_of(names,
                             [this](const std::string& name) { return entries_.contains(name); });
}

std::vector<msg::ParameterValue> ParameterStore::get_parameters(
    std::span<const std::string> names) const {
  std::vector<msg::ParameterValue> values;
  if (!knows_all(names)) return values;
  for (const std::string& name : names) values.push_back(*find(name));
  return values;
}

std::vector<std::uint8_t> ParameterStore::get_types(std::span<const std::string> names) const {
  std::vector<std::uint8_t> types;
  if (!knows_all(names)) return types;
  for (const std::string& name : names) types.push_back(find(name)->type);
  return types;
}

std::vector<msg::ParameterDescriptor> ParameterStore::describe(
    std::span<const std::string> names) const {
  std::vector<msg::ParameterDescriptor> descriptors;
  if (!knows_all(names)) return descriptors;
  for (const std::string& name : names)
    descriptors.push_back(entries_.find(name)->second.descriptor);
  return descriptors;
}

ParameterStore::Listing ParameterStore::list(std::span<const std::string> prefixes,
                                             std::uint64_t depth) const {
  const auto is_within = [depth](std::string_view below) {
    return depth == 0 || static_cast<std::uint64_t>(std::ranges::count(below, kSeparator)) < depth;
  };
  const auto matches = [&](const std::string& name) {
    if (prefixes.empty()) return is_within(name);
    return std::ranges::any_of(prefixes, [&](const std::string& prefix) {
      if (name == prefix) return true;
      return name.starts_with(prefix + kSeparator) &&
             is_within(std::string_view(name).substr(prefix.size()));
    });
  };
  Listing listing;
  for (const auto& [name, entry] : entries_) {
    if (!matches(name)) continue;
    listing.names.push_back(name);
    const auto last = name.rfind(kSeparator);
    if (last == std::string::npos) continue;
    const std::string prefix = name.substr(0, last);
    if (std::ranges::find(listing.prefixes, prefix) == listing.prefixes.end())
      listing.prefixes.push_back(prefix);
  }
  return listing;
}

}  // namespace culprit::ros2
