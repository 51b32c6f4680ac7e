#include "fleet/incident_number.h"

#include <charconv>

namespace culprit::fleet {
namespace {

constexpr int kBaseOfId = 36;
constexpr std::size_t kSuffix = 3;                      // digits behind the dash
constexpr std::int64_t kFirst = 3'656'158'440'062'976;  // 36^10: a smaller number is a row

}  // namespace

std::int64_t incident_number(std::string_view id) {
  const std::size_t dash = id.find('-');
  if (dash == std::string_view::npos || dash + 1 + kSuffix != id.size()) return 0;
  const std::string digits = std::string(id.substr(0, dash)) + std::string(id.substr(dash + 1));
  std::int64_t number = 0;
  const char* end = digits.data() + digits.size();
  const auto read = std::from_chars(digits.data(), end, number, kBaseOfId);
  return read.ec == std::errc() && read.ptr == end && number >= kFirst ? number : 0;
}

std::string incident_id(std::int64_t number) {
  if (number < kFirst) return "";
  constexpr std::size_t kMost = 16;
  char digits[kMost];
  const auto written = std::to_chars(digits, digits + kMost, number, kBaseOfId);
  std::string id(digits, written.ptr);
  id.insert(id.size() - kSuffix, "-");
  return id;
}

}  // namespace culprit::fleet
