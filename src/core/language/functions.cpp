#include "language/functions.h"

#include <algorithm>

namespace culprit {
namespace {

using enum Argument;

constexpr std::array<FunctionInfo, 23> kFunctions = {{
    {Function::kRate,
     "rate",
     "rate(topic) or rate(topic, window); topic FROM component: of one publisher",
     {kTopic, kExpression},
     1,
     2},
    {Function::kAge, "age", "age(topic) or age(topic FROM component)", {kTopic, kTopic}, 1, 1},
    {Function::kPhi, "phi", "phi(topic) or phi(topic FROM component)", {kTopic, kTopic}, 1, 1},
    {Function::kLoss, "loss", "loss(topic) or loss(topic FROM component)", {kTopic, kTopic}, 1, 1},
    {Function::kAlive, "alive", "alive(component)", {kComponent, kComponent}, 1, 1},
    {Function::kLifecycle, "lifecycle", "lifecycle(component)", {kComponent, kComponent}, 1, 1},
    {Function::kParameter,
     "parameter",
     "parameter(component, name)",
     {kComponent, kParameter},
     2,
     2},
    {Function::kLevel, "level", "level(diagnostic)", {kDiagnostic, kDiagnostic}, 1, 1},
    {Function::kMean, "mean", "mean(signal, window)", {kExpression, kExpression}, 2, 2},
    {Function::kMin, "min", "min(signal, window) or min(a, b)", {kExpression, kExpression}, 2, 2},
    {Function::kMax, "max", "max(signal, window) or max(a, b)", {kExpression, kExpression}, 2, 2},
    {Function::kStddev, "stddev", "stddev(signal, window)", {kExpression, kExpression}, 2, 2},
    {Function::kChanged, "changed", "changed(signal)", {kExpression, kExpression}, 1, 1},
    {Function::kIsNan, "isnan", "isnan(signal)", {kExpression, kExpression}, 1, 1},
    {Function::kFrozen, "frozen", "frozen(signal, window)", {kExpression, kExpression}, 2, 2},
    {Function::kCpu, "cpu", "cpu(component)", {kComponent, kComponent}, 1, 1},
    {Function::kMemory, "memory", "memory(component)", {kComponent, kComponent}, 1, 1},
    {Function::kGoals,
     "goals",
     "goals(action, aborted, window); or accepted, succeeded, canceled",
     {kAction, kOutcome, kExpression},
     3,
     3},
    {Function::kGoalAge, "goal_age", "goal_age(action)", {kAction}, 1, 1},
    {Function::kLogs,
     "logs",
     "logs(component, ERROR, window); or DEBUG, INFO, WARN, FATAL",
     {kComponent, kLogLevel, kExpression},
     3,
     3},
    {Function::kAbs, "abs", "abs(number)", {kExpression, kExpression}, 1, 1},
    {Function::kPow, "pow", "pow(base, exponent)", {kExpression, kExpression}, 2, 2},
    {Function::kSqrt, "sqrt", "sqrt(number)", {kExpression, kExpression}, 1, 1},
}};

}  // namespace

const FunctionInfo* find_function(std::string_view name) {
  const auto found = std::find_if(kFunctions.begin(), kFunctions.end(),
                                  [&](const FunctionInfo& f) { return f.name == name; });
  return found == kFunctions.end() ? nullptr : &*found;
}

std::vector<std::string_view> function_names() {
  std::vector<std::string_view> names;
  for (const FunctionInfo& f : kFunctions) names.push_back(f.name);
  return names;
}

}  // namespace culprit
