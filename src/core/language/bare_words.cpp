#include "language/bare_words.h"

#include <algorithm>
#include <array>
#include <initializer_list>

#include "language/facts.h"
#include "language/functions.h"
#include "language/line_reader.h"

namespace culprit {
namespace {

using syntax::Expression;
using Kind = Expression::Kind;

std::string remedy_of_bare_value(const Expression& left, const std::string& name) {
  const std::string word = upper_case(name);
  const auto is_one_of = [&](std::initializer_list<std::string_view> words) {
    return std::ranges::find(words, word) != words.end();
  };
  if (is_one_of({"NAN"}))
    return "write isnan(" + (left.kind == Kind::kName ? left.name.text : "signal") + ")";
  const bool is_nothing = is_one_of({"NULL", "NONE", "NIL", "UNKNOWN", "UNDEFINED"});
  if (is_nothing && is_call_of(left, "lifecycle"))
    return "write !alive(" + left.children[0].name.text + "), which detects that it is down";
  if (is_nothing)
    return "no value can be compared with a missing one: age(/topic) > 1s detects that none comes";
  if (is_one_of({"YES", "ON"})) return "write true";
  if (is_one_of({"NO", "OFF"})) return "write false";
  return "write a value, or declare it: CONST " + name + " = 0.5, or SIGNAL " + name + " ...";
}

}  // namespace

bool is_call_of(const Expression& e, std::string_view function) {
  return e.kind == Kind::kCall && e.name.text == function;
}

std::optional<std::string> level_number(std::string_view word) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kLevels = {
      {{"OK", "0"}, {"WARN", "1"}, {"WARNING", "1"}, {"ERROR", "2"}, {"STALE", "3"}}};
  const std::string upper = upper_case(word);
  for (const auto& [level, number] : kLevels) {
    if (level == upper) return std::string(number);
  }
  return std::nullopt;
}

std::string level_remedy(const std::string& number) {
  return "a level is a number (0 OK, 1 WARN, 2 ERROR, 3 STALE): write " + number;
}

void BareWords::warn_of_bare_function(const Expression& e) {
  const FunctionInfo* function = find_function(e.name.text);
  if (function == nullptr || !symbols_.is_looked_up(e.name.text)) return;
  diagnostics_.push_back(
      {Code::kUnknownName, Severity::kWarning, e.span,
       "without parentheses, '" + e.name.text + "' is a signal, which is looked up on the robot",
       "usage of the function: " + std::string(function->usage)});
}

bool BareWords::compares_with_nothing(const Expression& e) {
  constexpr std::array<std::string_view, 5> kNothing = {"NAN", "NONE", "NULL", "NIL", "UNDEFINED"};
  const Expression& side = e.children[1];
  const bool is_so = side.kind == Kind::kName && symbols_.is_looked_up(side.name.text) &&
                     std::ranges::find(kNothing, upper_case(side.name.text)) != kNothing.end();
  if (!is_so) return false;
  symbols_.forget_near_miss(side.name.text);
  diagnostics_.push_back({Code::kUnknownName, Severity::kError, side.span,
                          "'" + side.name.text + "' is no value of the language",
                          remedy_of_bare_value(e.children[0], side.name.text)});
  return true;
}

void BareWords::warn_of_bare_text(const Expression& e) {
  for (const Expression& side : e.children) {
    if (side.kind != Kind::kName || !symbols_.is_looked_up(side.name.text)) continue;
    std::string name = side.name.text;
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
    if (std::ranges::find(kLifecycleStates, name) == kLifecycleStates.end()) continue;
    diagnostics_.push_back(
        {Code::kUnknownName, Severity::kWarning, side.span,
         "without quotes, '" + side.name.text + "' is a signal, which is looked up on the robot",
         "a state stands in quotes: write \"" + name + "\"", Edit{side.span, "\"" + name + "\""}});
  }
}

void BareWords::warn_of_bare_value(const Expression& e) {
  const Expression& left = e.children[0];
  const Expression& right = e.children[1];
  const auto is_unknown_name = [&](const Expression& side) {
    return side.kind == Kind::kName && symbols_.is_looked_up(side.name.text);
  };
  const bool is_value = left.kind == Kind::kLiteral;
  if (is_value || !is_unknown_name(right) || is_unknown_name(left)) return;
  const bool is_reported =
      std::ranges::any_of(diagnostics_, [&](const Diagnostic& d) { return d.span == right.span; });
  if (is_reported) return;
  const std::string& name = right.name.text;
  diagnostics_.push_back(
      {Code::kUnknownName, Severity::kWarning, right.span,
       "'" + name + "' is not declared: it is a signal, which is looked up on the robot",
       remedy_of_bare_value(left, name)});
}

bool BareWords::check_bare_level(const Expression& e) {
  for (std::size_t i = 0; i < 2; ++i) {
    const Expression& side = e.children[i];
    if (!is_call_of(e.children[1 - i], "level") || side.kind != Kind::kName ||
        !symbols_.is_looked_up(side.name.text))
      continue;
    const auto number = level_number(side.name.text);
    if (!number) continue;
    diagnostics_.push_back({Code::kUnknownName, Severity::kError, side.span,
                            "signal '" + side.name.text + "' is not declared",
                            level_remedy(*number), Edit{side.span, *number}});
    return false;
  }
  return true;
}

}  // namespace culprit
