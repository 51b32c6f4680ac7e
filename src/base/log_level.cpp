#include "base/log_level.h"

#include <algorithm>
#include <array>
#include <utility>

namespace culprit {
namespace {

constexpr std::array<std::pair<LogLevel, std::string_view>, 5> kLevels = {
    {{LogLevel::kDebug, "DEBUG"},
     {LogLevel::kInfo, "INFO"},
     {LogLevel::kWarn, "WARN"},
     {LogLevel::kError, "ERROR"},
     {LogLevel::kFatal, "FATAL"}}};

}  // namespace

std::string_view to_string(LogLevel level) {
  return std::ranges::find(kLevels, level, [](const auto& each) { return each.first; })->second;
}

std::vector<std::string_view> log_levels() {
  std::vector<std::string_view> words;
  for (const auto& [level, word] : kLevels) words.push_back(word);
  return words;
}

std::optional<LogLevel> log_level(std::string_view word) {
  const auto found = std::ranges::find(kLevels, word, [](const auto& each) { return each.second; });
  return found == kLevels.end() ? std::nullopt : std::optional(found->first);
}

LogLevel log_level(std::uint8_t number) {
  LogLevel nearest = LogLevel::kDebug;
  for (const auto& [level, word] : kLevels) {
    if (static_cast<std::uint8_t>(level) <= number) nearest = level;
  }
  return nearest;
}

}  // namespace culprit
