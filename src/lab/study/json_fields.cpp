#include "study/json_fields.h"

#include <cmath>

namespace culprit::study {
namespace {

const Json kNull;
const Json kNoObject = Json::object();
const Json kNoArray = Json::array();

}  // namespace

JsonFields::JsonFields(const Json& json) : json_(json.is_object() ? json : kNoObject) {
  if (!json.is_object()) complaint_ = "it is no JSON object";
}

const Json& JsonFields::at(std::string_view name) {
  const auto field = json_.find(std::string(name));
  if (field == json_.end()) {
    complain(name, "is missing");
    return kNull;
  }
  ++read_;
  return *field;
}

void JsonFields::complain(std::string_view name, std::string_view what) {
  if (complaint_.empty()) complaint_.append(name).append(" ").append(what);
}

void JsonFields::complain_inside(std::string_view name, const std::string& complaint) {
  if (!complaint.empty()) complain(name, "is wrong: " + complaint);
}

bool JsonFields::truth(std::string_view name) {
  const Json& value = at(name);
  if (!value.is_boolean()) complain(name, "is neither true nor false");
  return value.is_boolean() && value.get<bool>();
}

double JsonFields::number(std::string_view name) {
  const Json& value = at(name);
  if (value.is_number() && std::isfinite(value.get<double>())) return value.get<double>();
  complain(name, "is no finite number");
  return 0;
}

std::vector<double> JsonFields::numbers(std::string_view name) {
  std::vector<double> numbers;
  for (const Json& value : array(name)) {
    if (!value.is_number() || !std::isfinite(value.get<double>())) {
      complain(name, "holds something that is no finite number");
      return {};
    }
    numbers.push_back(value.get<double>());
  }
  return numbers;
}

std::string JsonFields::text(std::string_view name) {
  const Json& value = at(name);
  if (value.is_string()) return value.get<std::string>();
  complain(name, "is no text");
  return "";
}

std::uint64_t JsonFields::natural(std::string_view name, std::uint64_t most) {
  const Json& value = at(name);
  if (value.is_number_unsigned() && value.get<std::uint64_t>() <= most)
    return value.get<std::uint64_t>();
  complain(name, "is no whole number from 0 to " + std::to_string(most));
  return 0;
}

std::int32_t JsonFields::integer(std::string_view name, std::int32_t least) {
  const Json& value = at(name);
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  const bool is_small = value.is_number_unsigned()
                            ? value.get<std::uint64_t>() <= std::uint64_t{kMost}
                            : value.is_number_integer();
  const std::int64_t number = is_small ? value.get<std::int64_t>() : std::int64_t{kMost} + 1;
  if (number >= least && number <= kMost) return static_cast<std::int32_t>(number);
  complain(name, "is no whole number of at least " + std::to_string(least));
  return 0;
}

bool JsonFields::is_null(std::string_view name) {
  const auto field = json_.find(std::string(name));
  if (field == json_.end() || !field->is_null()) return false;
  ++read_;
  return true;
}

const Json& JsonFields::object(std::string_view name) {
  const Json& value = at(name);
  if (value.is_object()) return value;
  complain(name, "is no JSON object");
  return kNoObject;
}

const Json& JsonFields::array(std::string_view name) {
  const Json& value = at(name);
  if (value.is_array()) return value;
  complain(name, "is no JSON array");
  return kNoArray;
}

std::string JsonFields::complaint() const {
  if (complaint_.empty() && read_ < json_.size()) return "there are more fields than known";
  return complaint_;
}

}  // namespace culprit::study
