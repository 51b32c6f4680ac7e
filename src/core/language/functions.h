// The functions that expressions may call.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace culprit {

enum class Function : std::uint8_t {
  kRate,
  kAge,
  kPhi,
  kLoss,
  kAlive,
  kLifecycle,
  kParameter,
  kLevel,
  kMean,
  kMin,
  kMax,
  kStddev,
  kChanged,
  kIsNan,
  kFrozen,
  kCpu,
  kMemory,
  kGoals,
  kGoalAge,
  kLogs,
  kAbs,
  kPow,
  kSqrt
};

// The kind of argument. Names of topics, components, parameters and diagnostics are written bare;
// they are no expressions.
enum class Argument : std::uint8_t {
  kTopic,
  kComponent,
  kParameter,
  kDiagnostic,
  kAction,
  kOutcome,
  kLogLevel,
  kExpression
};

struct FunctionInfo {
  Function function;
  std::string_view name;
  std::string_view usage;  // for messages
  std::array<Argument, 3> arguments;
  std::size_t min_arguments;
  std::size_t max_arguments;
};

// Null if there is no such function.
const FunctionInfo* find_function(std::string_view name);
std::vector<std::string_view> function_names();

}  // namespace culprit
