#include "link/list_parameter.h"

#include <algorithm>

#include "base/value_list.h"
#include "ros2/parameter_store.h"

namespace culprit::link {
namespace {

using ros2::msg::ParameterType;

template <class Elements>
std::vector<Value> values_of(const Elements& elements) {
  std::vector<Value> list;
  for (const auto& each : elements) list.push_back(each);
  return list;
}

// Nothing: one of them is of another type.
template <class Element>
bool take_all(const std::vector<Value>& list, std::vector<Element>& elements) {
  for (const Value& each : list) {
    const auto* element = std::get_if<Element>(&each);
    const auto* whole = std::get_if<std::int64_t>(&each);
    if constexpr (std::is_same_v<Element, double>) {
      if (element == nullptr && whole == nullptr) return false;
      elements.push_back(element != nullptr ? *element : static_cast<double>(*whole));
    } else {
      if (element == nullptr) return false;
      elements.push_back(*element);
    }
  }
  return true;
}

bool take_bytes(const std::vector<Value>& list, std::vector<std::uint8_t>& bytes) {
  for (const Value& each : list) {
    const auto* whole = std::get_if<std::int64_t>(&each);
    if (whole == nullptr || *whole < 0 || *whole > UINT8_MAX) return false;
    bytes.push_back(static_cast<std::uint8_t>(*whole));
  }
  return true;
}

}  // namespace

bool is_list(const ros2::msg::ParameterValue& value) {
  return value.type >= static_cast<std::uint8_t>(ParameterType::kByteArray) &&
         value.type <= static_cast<std::uint8_t>(ParameterType::kStringArray);
}

std::optional<Value> value_or_list(const ros2::msg::ParameterValue& value) {
  switch (static_cast<ParameterType>(value.type)) {
    case ParameterType::kByteArray: {
      const std::vector<std::int64_t> bytes(value.byte_array_value.begin(),
                                            value.byte_array_value.end());
      return text_of_list(values_of(bytes));
    }
    case ParameterType::kBoolArray: {
      std::vector<Value> list;
      for (const bool each : value.bool_array_value) list.push_back(each);
      return text_of_list(list);
    }
    case ParameterType::kIntegerArray:
      return text_of_list(values_of(value.integer_array_value));
    case ParameterType::kDoubleArray:
      return text_of_list(values_of(value.double_array_value));
    case ParameterType::kStringArray:
      return text_of_list(values_of(value.string_array_value));
    default:
      return ros2::to_value(value);
  }
}

std::optional<ros2::msg::ParameterValue> list_parameter(const std::string& text,
                                                        std::uint8_t type) {
  const auto list = list_from_text(text);
  if (!list) return std::nullopt;
  ros2::msg::ParameterValue out;
  out.type = type;
  const auto fits = [&] {
    switch (static_cast<ParameterType>(type)) {
      case ParameterType::kByteArray:
        return take_bytes(*list, out.byte_array_value);
      case ParameterType::kBoolArray:
        return take_all(*list, out.bool_array_value);
      case ParameterType::kIntegerArray:
        return take_all(*list, out.integer_array_value);
      case ParameterType::kDoubleArray:
        return take_all(*list, out.double_array_value);
      case ParameterType::kStringArray:
        return take_all(*list, out.string_array_value);
      default:
        return false;
    }
  };
  return fits() ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace culprit::link
