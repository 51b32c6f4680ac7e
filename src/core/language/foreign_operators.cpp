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

// "battery is None", "battery IS NOT NULL"
std::optional<Diagnostic> nothing_in_words(const Token& verb, const Scanner& scanner) {
  Scanner ahead = scanner.ahead();
  ahead.next();
  Token second = ahead.next();
  const bool is_negated = upper_case(second.text) == "NOT";
  if (is_negated) second = ahead.next();
  const std::string upper = upper_case(second.text);
  if (upper != "NONE" && upper != "NULL" && upper != "NIL") return std::nullopt;
  const Span span{verb.span.begin, second.span.end};
  return Diagnostic{Code::kSyntax, Severity::kError, span,
                    "'" + std::string(scanner.text(span)) + "' is no comparison",
                    is_negated ? "remove it: a comparison with an unknown value is not true"
                               : "age(/topic) > 1s detects that no value comes"};
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
  const bool is_of_texts = behind.peek().kind == Token::Kind::kString ||
                           scanner.text(behind.peek().span).starts_with('\'');
  if (!is_list || (!is_negated && !is_of_texts)) return std::nullopt;
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

std::optional<Diagnostic> letter_before_text(const Token& word, const Scanner& scanner) {
  const std::string_view next = scanner.text({word.span.end, word.span.end + 1});
  const bool is_prefix = word.kind == Token::Kind::kIdentifier && word.text.size() == 1;
  if (!is_prefix || (next != "\"" && next != "'")) return std::nullopt;
  return Diagnostic{Code::kSyntax,
                    Severity::kError,
                    word.span,
                    "no letter stands in front of a text",
                    "remove the '" + std::string(word.text) + "'",
                    Edit{word.span, ""}};
}

namespace {

// A word behind a condition, and what to write instead.
struct WordBehind {
  std::string_view word, remedy;
};

// Empty: `upper` is none.
std::string_view remedy_behind_condition(std::string_view upper) {
  constexpr std::string_view kActs =
      "end the line here: what to do stands below, on a STRATEGY and its ADAPTATION lines";
  constexpr std::string_view kWhole =
      "compare with the whole text, as in lifecycle(camera) == \"active\"";
  constexpr auto kWords = std::to_array<WordBehind>(
      {{"THEN", kActs},
       {"DO", kActs},
       {"LIKE", kWhole},
       {"MATCHES", kWhole},
       {"CONTAINS", kWhole},
       {"OFFSET", "remove it: a condition is about now; mean(signal, 10s) is over time"},
       {"BY", "remove it: a signal is one value; mean(battery, 10s) is over time"}});
  const auto found = std::ranges::find(kWords, upper, &WordBehind::word);
  return found == kWords.end() ? "" : found->remedy;
}

// A sign behind a condition: "lifecycle(camera).text", "battery[0]", "alive(a), alive(b)".
std::optional<Diagnostic> sign_behind_condition(const Token& token, const Scanner& scanner) {
  const std::uint32_t begin = token.span.begin;
  const std::string_view before = begin > 0 ? scanner.text({begin - 1, begin}) : "";
  const std::string_view after = scanner.text({token.span.end, token.span.end + 1});
  const std::string_view written = scanner.text(token.span);
  constexpr std::string_view kDigits = "0123456789";
  const bool is_of_number = !before.empty() && !after.empty() &&
                            kDigits.find(before) != std::string_view::npos &&
                            kDigits.find(after) != std::string_view::npos;
  if (token.is(",") && !is_of_number)
    return Diagnostic{Code::kExtraText,
                      Severity::kError,
                      token.span,
                      "unexpected ',' between two conditions",
                      "write && if both must hold, || if one is enough",
                      Edit{token.span, " &&"}};
  if (written == "." && before == ")")
    return Diagnostic{Code::kBadToken, Severity::kError, token.span, "a value has no methods",
                      "compare it, as in lifecycle(camera) == \"active\""};
  const bool is_bracket = token.flaw == Token::Flaw::kMeaningless &&
                          std::string_view("{}[]").find(written) != std::string_view::npos;
  if (!is_bracket) return std::nullopt;
  return Diagnostic{
      Code::kBadToken, Severity::kError, token.span,
      "'" + std::string(written) + "' means nothing here",
      "a function has parentheses, as in alive(camera); a signal has no labels, and no index"};
}

}  // namespace

std::optional<Diagnostic> behind_condition(const Scanner& scanner) {
  const Token& token = scanner.peek();
  if (auto slip = sign_behind_condition(token, scanner)) return slip;
  const std::string written(token.text);
  const std::string upper = upper_case(written);
  if (const auto remedy = remedy_behind_condition(upper); !remedy.empty())
    return Diagnostic{Code::kExtraText, Severity::kError, token.span,
                      "unexpected '" + written + "' behind a condition", std::string(remedy)};
  if (upper == "UNLESS")
    return Diagnostic{Code::kExtraText, Severity::kError, token.span,
                      "'" + written + "' is no operator",
                      "write && and the condition with ! in front, as in && !docked"};
  if (upper == "IF")
    return Diagnostic{Code::kExtraText,
                      Severity::kError,
                      token.span,
                      "'" + written + "' is no operator",
                      "write && and the condition, as in && docked",
                      Edit{token.span, "&&"}};
  if (is_hertz(written))
    return Diagnostic{Code::kExtraText,
                      Severity::kError,
                      token.span,
                      "rates are in Hz and have no unit",
                      "remove '" + written + "'",
                      Edit{token.span, ""}};
  if (upper == "FROM")
    return Diagnostic{Code::kExtraText, Severity::kError, token.span,
                      "FROM stands inside the parentheses",
                      "write it behind the topic, as in age(/scan FROM lidar)"};
  if (syntax::adaptation_type(written))
    return Diagnostic{
        Code::kExtraText, Severity::kError, token.span,
        "'" + written + "' is an adaptation, and no part of a condition",
        "write only the condition, as in speed < 0.1; what to do stands in a STRATEGY"};
  return std::nullopt;
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
