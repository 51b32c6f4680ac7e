#include "language/type_mismatch.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "base/units.h"
#include "language/bare_words.h"

namespace culprit {
namespace {

using syntax::Expression;
using Kind = Expression::Kind;

// "rate(/scan) < 125ms": `pause` is between two messages.
std::string remedy_of_rate(const Expression& pause) {
  const auto* length =
      pause.kind == Kind::kLiteral ? std::get_if<Duration>(&*pause.literal) : nullptr;
  const auto milliseconds =
      length == nullptr ? 0
                        : std::chrono::duration_cast<std::chrono::milliseconds>(*length).count();
  constexpr std::int64_t kSecond = 1000;  // in milliseconds
  if (milliseconds < 1 || kSecond % milliseconds != 0)
    return "a rate is a number in Hz: write the number without a unit";
  return "a rate is a number in Hz: one message every " + to_string(*length) + " is " +
         std::to_string(kSecond / milliseconds) + "; age(/topic) is the time since the last one";
}

// `number`: which side of `e` is none of a duration.
std::string unit_remedy(const Expression& e, std::size_t number) {
  const Expression& side = e.children[number];
  if (side.kind == Kind::kCall && side.name.text == "rate")
    return remedy_of_rate(e.children[1 - number]);
  constexpr std::array<std::string_view, 5> kNumbers = {"phi", "loss", "cpu", "memory", "goals"};
  if (side.kind == Kind::kCall && std::ranges::find(kNumbers, side.name.text) != kNumbers.end())
    return side.name.text + " is a number: write the other side without a unit";
  const auto* whole =
      side.kind == Kind::kLiteral ? std::get_if<std::int64_t>(&*side.literal) : nullptr;
  if (whole != nullptr)
    return "add a unit to the number: " + std::to_string(*whole) + "s or " +
           std::to_string(*whole) + "ms";
  return "give the number a unit, as in 500ms or 2s";
}

// `truth`: which side of `e` is true or false.
std::string truth_remedy(const Expression& e, std::size_t truth) {
  const bool is_literal = e.children[truth].kind == Kind::kLiteral;
  return is_literal ? "compare it with a number, as in x > 0.5"
                    : "write the condition by itself, or ! in front of it";
}

// `other`: which side of `e` is no text.
std::string text_remedy(const Expression& e, std::size_t other, const Symbols& symbols) {
  const Expression& side = e.children[other];
  const Expression& text = e.children[1 - other];
  const auto* written =
      text.kind == Kind::kLiteral ? std::get_if<std::string>(&*text.literal) : nullptr;
  const auto* constant = text.kind == Kind::kName ? symbols.constant(text.name.text) : nullptr;
  if (constant != nullptr)
    return "'" + text.name.text + "' is a text: remove the quotes in its CONST line";
  if (written != nullptr && symbols.constant(*written) != nullptr)
    return "'" + *written + "' is a constant: remove the quotes";
  if (written == nullptr)
    return "this side is a text: compare it with a text in quotes, as in \"active\"";
  if (*written == "true" || *written == "false") return "write " + *written + " without quotes";
  if (parse_duration(*written)) return "write " + *written + " without quotes";
  double number = 0;
  const char* end = written->data() + written->size();
  const auto read = std::from_chars(written->data(), end, number);
  if (read.ec == std::errc() && read.ptr == end) return "write " + *written + " without quotes";
  const std::string name = side.kind == Kind::kName ? "'" + side.name.text + "'" : "the other side";
  return "\"" + *written + "\" is a text, and " + name + " is not: compare values of one type";
}

}  // namespace

bool is_comparison(const Expression& e) {
  using enum syntax::Operator;
  return e.kind == Kind::kBinary && e.op >= kLess && e.op <= kNotEqual;
}

Diagnostic type_mismatch(const Expression& e, Type left, Type right, const std::string& verb,
                         const Symbols& symbols) {
  std::string remedy;
  std::optional<Edit> fix;
  const bool duration_and_number = (left == Type::kDuration && is_numeric(right)) ||
                                   (right == Type::kDuration && is_numeric(left));
  if (duration_and_number) remedy = unit_remedy(e, left == Type::kDuration ? 1 : 0);
  if (verb == "compare" && (left == Type::kString || right == Type::kString))
    remedy = text_remedy(e, left == Type::kString ? 1 : 0, symbols);
  if (verb == "compare" && remedy.empty() && (left == Type::kBool || right == Type::kBool))
    remedy = truth_remedy(e, left == Type::kBool ? 0 : 1);
  if (verb != "compare" && left == Type::kString && right == Type::kString)
    remedy = "texts can only be compared: write the whole text in one pair of quotes";
  if (verb != "compare" && (left == Type::kBool || right == Type::kBool))
    remedy = "join conditions with && or ||, as in !alive(a) || !alive(b)";
  if (verb == "compare" && is_comparison(e.children[0]))
    remedy = "to test a range, write a < x && x < b";
  for (std::size_t i = 0; i < 2 && verb == "compare"; ++i) {
    const Expression& text = e.children[i];
    const bool is_text =
        text.kind == Kind::kLiteral && std::holds_alternative<std::string>(*text.literal);
    if (!is_text || !is_call_of(e.children[1 - i], "level")) continue;
    const auto number = level_number(std::get<std::string>(*text.literal));
    if (!number) continue;
    remedy = level_remedy(*number);
    fix = Edit{text.span, *number};
  }
  return {Code::kTypeMismatch,
          Severity::kError,
          e.span,
          "cannot " + verb + " " + describe(left) + " and " + describe(right),
          std::move(remedy),
          std::move(fix)};
}

}  // namespace culprit
