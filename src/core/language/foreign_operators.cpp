#include "language/foreign_operators.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <string_view>
#include <utility>

#include "language/functions.h"
#include "language/line_reader.h"
#include "language/reserved_words.h"

namespace culprit {
namespace {

using syntax::Expression;

Diagnostic wrong_operator(Span span, const std::string& written, const std::string& meant) {
  return {Code::kSyntax,    Severity::kError, span, "'" + written + "' is no operator",
          "write " + meant, Edit{span, meant}};
}

// The operator that a word stands for; empty: it is none.
std::string_view operator_of_word(std::string_view word) {
  constexpr auto kWords = std::to_array<std::pair<std::string_view, std::string_view>>(
      {{"and", "&&"},    {"or", "||"},     {"is", "=="},     {"equals", "=="}, {"equal", "=="},
       {"eq", "=="},     {"gt", ">"},      {"lt", "<"},      {"ge", ">="},     {"gte", ">="},
       {"le", "<="},     {"lte", "<="},    {"ne", "!="},     {"above", ">"},   {"over", ">"},
       {"exceeds", ">"}, {"greater", ">"}, {"more", ">"},    {"larger", ">"},  {"below", "<"},
       {"under", "<"},   {"less", "<"},    {"smaller", "<"}, {"lower", "<"},   {"higher", ">"}});
  std::string lower(word);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const auto& [theirs, ours] : kWords) {
    if (theirs == lower) return ours;
  }
  return "";
}

// A word for the state of a component: "camera is dead".
std::optional<bool> is_word_for_alive(std::string_view word) {
  constexpr std::array<std::string_view, 4> kAlive = {"alive", "up", "running", "online"};
  constexpr std::array<std::string_view, 8> kDown = {"dead",   "down",    "gone",    "offline",
                                                     "exited", "crashed", "missing", "stopped"};
  if (std::ranges::find(kAlive, word) != kAlive.end()) return true;
  if (std::ranges::find(kDown, word) != kDown.end()) return false;
  return std::nullopt;
}

std::optional<Diagnostic> state_in_words(const Expression& left, const Token& verb,
                                         const Scanner& scanner) {
  Scanner ahead = scanner.ahead();
  ahead.next();
  const Token& second = ahead.peek();
  const auto is_alive = is_word_for_alive(second.text);
  if (left.kind != Expression::Kind::kName || !is_alive) return std::nullopt;
  const Span span{left.span.begin, second.span.end};
  const std::string meant = (*is_alive ? "alive(" : "!alive(") + left.name.text + ")";
  return Diagnostic{
      Code::kSyntax,
      Severity::kError,
      span,
      "'" + std::string(verb.text) + " " + std::string(second.text) + "' is no comparison",
      "write " + meant,
      Edit{span, meant}};
}

// "battery is None"
std::optional<Diagnostic> nothing_in_words(const Token& verb, const Scanner& scanner) {
  Scanner ahead = scanner.ahead();
  ahead.next();
  const Token& second = ahead.peek();
  const std::string upper = upper_case(second.text);
  if (upper != "NONE" && upper != "NULL" && upper != "NIL") return std::nullopt;
  const Span span{verb.span.begin, second.span.end};
  return Diagnostic{Code::kSyntax, Severity::kError, span,
                    "'" + std::string(scanner.text(span)) + "' is no comparison",
                    "age(/topic) > 1s detects that no value comes"};
}

// "in ("a", "b")", "not in ["a"]"
std::optional<Diagnostic> membership(const Token& first, const Scanner& scanner) {
  Scanner behind = scanner.ahead();
  behind.next();
  Span span = first.span;
  const bool is_negated = upper_case(first.text) == "NOT" && upper_case(behind.peek().text) == "IN";
  if (is_negated) span.end = behind.next().span.end;
  if (!is_negated && upper_case(first.text) != "IN") return std::nullopt;
  const Token open = behind.next();
  const bool is_list = open.is("(") || scanner.text(open.span) == "[";
  if (!is_list || (!is_negated && behind.peek().kind != Token::Kind::kString)) return std::nullopt;
  return Diagnostic{Code::kSyntax, Severity::kError, span,
                    "'" + std::string(scanner.text(span)) + "' is no operator",
                    is_negated ? "compare with each: x != \"a\" && x != \"b\""
                               : "compare with each: x == \"a\" || x == \"b\""};
}

std::optional<Diagnostic> operator_in_words(const Expression& left, const Token& first,
                                            const Scanner& scanner) {
  if (auto slip = membership(first, scanner)) return slip;
  if (upper_case(first.text) == "BETWEEN" || upper_case(first.text) == "IN")
    return Diagnostic{Code::kSyntax, Severity::kError, first.span,
                      "'" + std::string(first.text) + "' is no operator",
                      "to test a range, write low <= x && x <= high"};
  std::string meant(operator_of_word(first.text));
  if (meant.empty()) return std::nullopt;
  if (meant == "==") {
    if (auto slip = state_in_words(left, first, scanner)) return slip;
    if (auto slip = nothing_in_words(first, scanner)) return slip;
  }
  Scanner ahead = scanner.ahead();
  ahead.next();
  Span span = first.span;
  // "is not", "is greater than", "less than or equal to"
  for (Token next = ahead.next(); next.kind == Token::Kind::kIdentifier; next = ahead.next()) {
    const std::string word = upper_case(next.text);
    const std::string_view other = operator_of_word(next.text);
    const bool is_filler = word == "THAN" || word == "TO" || word == "THE";
    const bool joins = other == "&&" || (other == "||" && meant.size() == 2);
    if (word == "NOT" && meant == "==") {
      meant = "!=";
    } else if (joins || (!is_filler && other.empty())) {
      break;
    } else if (other == "==" && meant.size() == 1) {
      meant += "=";
    } else if (!other.empty() && other != "||") {
      meant = other;
    }
    span.end = next.span.end;
  }
  const std::string written(scanner.text(span));
  auto slip = wrong_operator(span, written, meant);
  slip.remedy += " for '" + written + "'";
  return slip;
}

}  // namespace

std::optional<Diagnostic> doubled_operator(const Token& first, const Token& second) {
  struct Slip {
    std::string_view first, second, meant;
  };
  constexpr std::array<Slip, 7> kSlips = {{{"<", ">", "!="},
                                           {">", ">", ">"},
                                           {"<", "<", "<"},
                                           {"==", "=", "=="},
                                           {"!=", "=", "!="},
                                           {">=", "=", ">="},
                                           {"<=", "=", "<="}}};
  for (const Slip& slip : kSlips) {
    if (first.is(slip.first) && second.is(slip.second))
      return wrong_operator({first.span.begin, second.span.end},
                            std::string(slip.first).append(slip.second), std::string(slip.meant));
  }
  if (first.is("/") && second.is("*"))
    return Diagnostic{Code::kExtraText,
                      Severity::kError,
                      {first.span.begin, second.span.end},
                      "no comment begins with '/*'",
                      "begin a comment with #",
                      Edit{{first.span.begin, second.span.end}, "#"}};
  if (!first.is("*") || !second.is("*")) return std::nullopt;
  return Diagnostic{Code::kSyntax,
                    Severity::kError,
                    {first.span.begin, second.span.end},
                    "'**' is no operator",
                    "write pow(base, exponent)"};
}

std::optional<Diagnostic> foreign_operator(const Expression& left, const Scanner& scanner) {
  const Token& token = scanner.peek();
  if (token.is("=")) {
    Scanner ahead = scanner.ahead();
    ahead.next();
    const Token& second = ahead.peek();
    const bool adjoins = second.span.begin == token.span.end;
    if (adjoins && (second.is(">") || second.is("<")))
      return wrong_operator({token.span.begin, second.span.end}, "=" + std::string(second.text),
                            std::string(second.text) + "=");
    if (adjoins && scanner.text(second.span) == "~")
      return Diagnostic{Code::kSyntax,
                        Severity::kError,
                        {token.span.begin, second.span.end},
                        "'=~' is no operator",
                        "compare with each: x == \"a\" || x == \"b\""};
    auto slip = wrong_operator(token.span, "=", "==");
    slip.remedy += " to compare";
    return slip;
  }
  if (token.is("!")) {
    Scanner ahead = scanner.ahead();
    ahead.next();
    const Token& second = ahead.peek();
    const bool is_so = second.span.begin == token.span.end && (second.is(">") || second.is("<"));
    if (is_so)
      return wrong_operator({token.span.begin, second.span.end}, "!" + std::string(second.text),
                            second.is(">") ? "<=" : ">=");
  }
  if (token.kind != Token::Kind::kIdentifier) return std::nullopt;
  return operator_in_words(left, token, scanner);
}

std::optional<Diagnostic> call_without_parentheses(const Expression& name, const Scanner& scanner) {
  const bool is_function =
      name.kind == Expression::Kind::kName && find_function(name.name.text) != nullptr;
  Scanner ahead = scanner.ahead();
  const Token& next = ahead.peek();
  const bool is_apart = next.span.begin > name.span.end;
  const bool is_word = next.kind == Token::Kind::kIdentifier || next.kind == Token::Kind::kString;
  if (!is_function || !is_apart || !is_word) return std::nullopt;
  const syntax::Name argument = ahead.next_name();
  const std::string upper = upper_case(argument.text);
  const auto words = reserved_words();
  const bool is_operator = !operator_of_word(argument.text).empty() || upper == "BETWEEN" ||
                           std::ranges::find(words, upper) != words.end();
  // A parameter of a template may be the number behind an expression that ends in this name.
  const bool is_parameter = argument.text.starts_with('{');
  if (argument.text.empty() || is_operator || is_parameter) return std::nullopt;
  const Span span{name.span.begin, argument.span.end};
  const std::string meant = name.name.text + "(" + argument.text + ")";
  return Diagnostic{
      Code::kSyntax,    Severity::kError, span, "the argument of a function stands in parentheses",
      "write " + meant, Edit{span, meant}};
}

}  // namespace culprit
