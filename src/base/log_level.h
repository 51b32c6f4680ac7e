// How severe a line of a node's log is.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace culprit {

// As rcl_interfaces/msg/Log numbers them.
enum class LogLevel : std::uint8_t {
  kDebug = 10,
  kInfo = 20,
  kWarn = 30,
  kError = 40,
  kFatal = 50
};

// "ERROR"
std::string_view to_string(LogLevel level);

// The words of the rule language, from the least severe on.
std::vector<std::string_view> log_levels();
// Empty for any other word.
std::optional<LogLevel> log_level(std::string_view word);
// The level of a line whose message has this number; the next lower one if it is none of them.
LogLevel log_level(std::uint8_t number);

}  // namespace culprit
