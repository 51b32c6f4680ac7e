#include "language/expression_parser.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <string>
#include <utility>

#include "base/closest.h"
#include "language/foreign_words.h"
#include "language/functions.h"
#include "language/line_reader.h"

namespace culprit {
namespace {

using syntax::Expression;
using syntax::Operator;
using Kind = Expression::Kind;

struct BinaryOperator {
  std::string_view symbol;
  Operator op;
  int precedence;
};
constexpr std::array kBinary = {
    BinaryOperator{"||", Operator::kOr, 1},       BinaryOperator{"&&", Operator::kAnd, 2},
    BinaryOperator{"==", Operator::kEqual, 3},    BinaryOperator{"!=", Operator::kNotEqual, 3},
    BinaryOperator{"<", Operator::kLess, 4},      BinaryOperator{"<=", Operator::kLessEqual, 4},
    BinaryOperator{">", Operator::kGreater, 4},   BinaryOperator{">=", Operator::kGreaterEqual, 4},
    BinaryOperator{"+", Operator::kAdd, 5},       BinaryOperator{"-", Operator::kSubtract, 5},
    BinaryOperator{"*", Operator::kMultiply, 6},  BinaryOperator{"/", Operator::kDivide, 6},
    BinaryOperator{"%", Operator::kRemainder, 6},
};

const BinaryOperator* binary_operator(const Token& token) {
  if (token.kind != Token::Kind::kSymbol) return nullptr;
  for (const BinaryOperator& candidate : kBinary) {
    if (candidate.symbol == token.text) return &candidate;
  }
  return nullptr;
}

// Moved one by one: a list in braces would copy whole trees.
template <class... Children>
void adopt(Expression& parent, Children&&... children) {
  parent.children.reserve(sizeof...(children));
  (parent.children.push_back(std::move(children)), ...);
}

class ExpressionParser {
 public:
  ExpressionParser(Scanner& scanner, std::vector<Diagnostic>& diagnostics)
      : scanner_(scanner), diagnostics_(diagnostics) {}

  std::optional<Expression> conditional(int depth) {
    auto condition = binary(1, depth);
    if (!condition || !scanner_.peek().is("?")) return condition;
    if (depth >= kMaxNesting) return too_deep();
    scanner_.next();
    auto yes = conditional(depth + 1);
    if (!yes ||
        !expect(":", "':' and the value for 'otherwise'", "write both values, as in x > 1 ? 2 : 3"))
      return std::nullopt;
    auto no = conditional(depth + 1);
    if (!no) return std::nullopt;
    Expression e;
    e.kind = Kind::kConditional;
    e.span = {condition->span.begin, no->span.end};
    adopt(e, std::move(*condition), std::move(*yes), std::move(*no));
    return e;
  }

 private:
  std::optional<Expression> binary(int min_precedence, int depth) {
    auto left = unary(depth);
    if (!left) return std::nullopt;
    // A long chain of operators nests to the left as deep as it is long, and later stages walk it
    // recursively.
    int length = 0;
    while (const BinaryOperator* found = binary_operator(scanner_.peek())) {
      if (found->precedence < min_precedence) break;
      if (++length + depth > kMaxNesting) return too_long();
      const Token op = scanner_.next();
      if (const Token& second = scanner_.peek(); op.span.end == second.span.begin) {
        if (auto slip = doubled(op, second)) return fail(std::move(*slip));
      }
      if (auto slip = per_second(*left, op, scanner_.peek())) return fail(std::move(*slip));
      if (op.is("%") && !begins_value(scanner_.peek()))
        return fail(
            Code::kSyntax, op.span, "unexpected '%' after a number",
            "write the value itself: a rate in Hz, a share from 0 to 1 (0.2 for 20 percent)");
      if (scanner_.at_end()) return unfinished(op);
      auto right = binary(found->precedence + 1, depth + length);
      if (!right) return std::nullopt;
      Expression e;
      e.kind = Kind::kBinary;
      e.op = found->op;
      e.span = {left->span.begin, right->span.end};
      adopt(e, std::move(*left), std::move(*right));
      left = std::move(e);
    }
    if (auto slip = foreign_operator(*left)) return fail(std::move(*slip));
    return left;
  }

  static bool begins_value(const Token& token) {
    return token.kind != Token::Kind::kEnd &&
           (token.kind != Token::Kind::kSymbol || token.is("(") || token.is("-") || token.is("+") ||
            token.is("!"));
  }

  static Diagnostic wrong_operator(Span span, const std::string& written,
                                   const std::string& meant) {
    return {Code::kSyntax,    Severity::kError, span, "'" + written + "' is no operator",
            "write " + meant, Edit{span, meant}};
  }

  // "<>", ">>", "===", "**": two symbols that other languages write as one.
  static std::optional<Diagnostic> doubled(const Token& first, const Token& second) {
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

  // "8/s"
  std::optional<Diagnostic> per_second(const Expression& left, const Token& op,
                                       const Token& second) const {
    const bool is_so = left.kind == Kind::kLiteral && op.is("/") &&
                       op.span.begin == left.span.end && second.span.begin == op.span.end &&
                       (second.text == "s" || second.text == "sec" || second.text == "second");
    if (!is_so) return std::nullopt;
    const Span span{left.span.begin, second.span.end};
    const std::string number(text_of(left.span));
    return Diagnostic{
        Code::kTypeMismatch, Severity::kError,  span, "rates are in Hz and have no unit",
        "write " + number,   Edit{span, number}};
  }

  std::nullopt_t unfinished(const Token& op) {
    return fail(Code::kSyntax, op.span, "a value is missing behind '" + std::string(op.text) + "'",
                "write the other side; a statement is one line");
  }

  // "alive camera": a function as other languages call it. "age /scan" is a division (typing.cpp).
  std::optional<Diagnostic> call_without_parentheses(const Expression& name) {
    const bool is_function = name.kind == Kind::kName && find_function(name.name.text) != nullptr;
    Scanner ahead = scanner_.ahead();
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
    return Diagnostic{Code::kSyntax,
                      Severity::kError,
                      span,
                      "the argument of a function stands in parentheses",
                      "write " + meant,
                      Edit{span, meant}};
  }

  // A word for the state of a component: "camera is dead".
  static std::optional<bool> is_word_for_alive(std::string_view word) {
    constexpr std::array<std::string_view, 4> kAlive = {"alive", "up", "running", "online"};
    constexpr std::array<std::string_view, 8> kDown = {"dead",   "down",    "gone",    "offline",
                                                       "exited", "crashed", "missing", "stopped"};
    if (std::ranges::find(kAlive, word) != kAlive.end()) return true;
    if (std::ranges::find(kDown, word) != kDown.end()) return false;
    return std::nullopt;
  }

  std::optional<Diagnostic> state_in_words(const Expression& left, const Token& verb) {
    Scanner ahead = scanner_.ahead();
    ahead.next();
    const Token& second = ahead.peek();
    const auto is_alive = is_word_for_alive(second.text);
    if (left.kind != Kind::kName || !is_alive) return std::nullopt;
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
  std::optional<Diagnostic> nothing_in_words(const Token& verb) const {
    Scanner ahead = scanner_.ahead();
    ahead.next();
    const Token& second = ahead.peek();
    const std::string upper = upper_case(second.text);
    if (upper != "NONE" && upper != "NULL" && upper != "NIL") return std::nullopt;
    const Span span{verb.span.begin, second.span.end};
    return Diagnostic{Code::kSyntax, Severity::kError, span,
                      "'" + std::string(text_of(span)) + "' is no comparison",
                      "age(/topic) > 1s detects that no value comes"};
  }

  // An operator of another language behind the value `left`.
  std::optional<Diagnostic> foreign_operator(const Expression& left) {
    const Token& token = scanner_.peek();
    if (token.is("=")) {
      Scanner ahead = scanner_.ahead();
      ahead.next();
      const Token& second = ahead.peek();
      const bool adjoins = second.span.begin == token.span.end;
      if (adjoins && (second.is(">") || second.is("<")))
        return wrong_operator({token.span.begin, second.span.end}, "=" + std::string(second.text),
                              std::string(second.text) + "=");
      if (adjoins && text_of(second.span) == "~")
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
      Scanner ahead = scanner_.ahead();
      ahead.next();
      const Token& second = ahead.peek();
      const bool is_so = second.span.begin == token.span.end && (second.is(">") || second.is("<"));
      if (is_so)
        return wrong_operator({token.span.begin, second.span.end}, "!" + std::string(second.text),
                              second.is(">") ? "<=" : ">=");
    }
    if (token.kind != Token::Kind::kIdentifier) return std::nullopt;
    return operator_in_words(left, token);
  }

  // The operator that a word stands for; empty: it is none.
  static std::string_view operator_of_word(std::string_view word) {
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

  // "in ("a", "b")", "not in ["a"]"
  std::optional<Diagnostic> membership(const Token& first) {
    Scanner behind = scanner_.ahead();
    behind.next();
    Span span = first.span;
    const bool is_negated =
        upper_case(first.text) == "NOT" && upper_case(behind.peek().text) == "IN";
    if (is_negated) span.end = behind.next().span.end;
    if (!is_negated && upper_case(first.text) != "IN") return std::nullopt;
    const Token open = behind.next();
    const bool is_list = open.is("(") || text_of(open.span) == "[";
    if (!is_list || (!is_negated && behind.peek().kind != Token::Kind::kString))
      return std::nullopt;
    return Diagnostic{Code::kSyntax, Severity::kError, span,
                      "'" + std::string(text_of(span)) + "' is no operator",
                      is_negated ? "compare with each: x != \"a\" && x != \"b\""
                                 : "compare with each: x == \"a\" || x == \"b\""};
  }

  std::optional<Diagnostic> operator_in_words(const Expression& left, const Token& first) {
    if (auto slip = membership(first)) return slip;
    if (upper_case(first.text) == "BETWEEN" || upper_case(first.text) == "IN")
      return Diagnostic{Code::kSyntax, Severity::kError, first.span,
                        "'" + std::string(first.text) + "' is no operator",
                        "to test a range, write low <= x && x <= high"};
    std::string meant(operator_of_word(first.text));
    if (meant.empty()) return std::nullopt;
    if (meant == "==") {
      if (auto slip = state_in_words(left, first)) return slip;
      if (auto slip = nothing_in_words(first)) return slip;
    }
    Scanner ahead = scanner_.ahead();
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
    const std::string written(text_of(span));
    auto slip = wrong_operator(span, written, meant);
    slip.remedy += " for '" + written + "'";
    return slip;
  }

  std::optional<Expression> unary(int depth) {
    const Token& ahead = scanner_.peek();
    if (!ahead.is("!") && !ahead.is("-") && !ahead.is("+")) return primary(depth);
    if (depth >= kMaxNesting) return too_deep();
    const Token token = scanner_.next();
    auto operand = unary(depth + 1);
    if (!operand) return std::nullopt;
    Expression e;
    e.kind = Kind::kUnary;
    e.op = token.is("!") ? Operator::kNot : token.is("-") ? Operator::kNegate : Operator::kPlus;
    e.span = {token.span.begin, operand->span.end};
    adopt(e, std::move(*operand));
    return e;
  }

  std::optional<Expression> primary(int depth) {
    const Token token = scanner_.next();
    Expression e;
    e.span = token.span;
    switch (token.kind) {
      case Token::Kind::kNumber:
        if (const auto unit = scanner_.next_letters(); !unit.empty()) {
          const auto blank = unit_behind_blank(token, unit);
          if (blank) return fail(blank->code, blank->span, blank->cause, blank->remedy, blank->fix);
        }
        e.literal = token.value();
        return e;
      case Token::Kind::kDuration:
      case Token::Kind::kString:
        e.literal = token.value();
        return e;
      case Token::Kind::kIdentifier:
        if (token.text == "true" || token.text == "false") {
          e.literal = token.value();
          return e;
        }
        if (token.text == "True" || token.text == "TRUE" || token.text == "False" ||
            token.text == "FALSE") {
          const std::string meant = token.text.front() == 'T' ? "true" : "false";
          return fail(Code::kSyntax, token.span, "'" + std::string(token.text) + "' is no value",
                      "write " + meant, Edit{token.span, meant});
        }
        if ((token.text == "not" || token.text == "NOT") && continues(scanner_.peek())) {
          return fail(Code::kSyntax, token.span, "'" + std::string(token.text) + "' is no operator",
                      "write ! for 'not', as in !docked",
                      Edit{{token.span.begin, scanner_.position()}, "!"});
        }
        if (const std::string upper = upper_case(token.text);
            (upper == "IF" || upper == "WHEN" || upper == "UNLESS") && continues(scanner_.peek()) &&
            !scanner_.peek().is("(")) {
          return fail(Code::kSyntax, token.span,
                      "unexpected '" + std::string(token.text) + "' before a condition",
                      "remove it", Edit{{token.span.begin, scanner_.position()}, ""});
        }
        if (is_reminder(token.text))
          return fail(Code::kPlaceholder, token.span,
                      "'" + std::string(token.text) + "' stands for something of yours",
                      "write the condition or the value in its place");
        e.kind = Kind::kName;
        e.name = {std::string(token.text), token.span};
        if (auto slip = call_without_parentheses(e)) return fail(std::move(*slip));
        return scanner_.peek().is("(") ? call(std::move(e), depth) : std::optional(std::move(e));
      case Token::Kind::kSymbol:
        if (token.is("(")) return parenthesis(token, depth);
        if (token.is("/")) return topic_for_value(token);
        break;
      case Token::Kind::kBad:
        return bad(token);
      case Token::Kind::kEnd:
        break;
    }
    return value_is_missing(token);
  }

  // A placeholder that people leave for later.
  static bool is_reminder(std::string_view word) {
    return word == "TODO" || word == "FIXME" || word == "TBD" || word == "XXX";
  }

  // "500 ms", "5 Hz"
  std::optional<Diagnostic> unit_behind_blank(const Token& number, std::string_view unit) {
    const auto end = scanner_.position() + static_cast<std::uint32_t>(unit.size());
    if (is_hertz(unit))
      return Diagnostic{Code::kSyntax,
                        Severity::kError,
                        {number.span.begin, end},
                        "rates are in Hz and have no unit",
                        "leave the unit out",
                        Edit{{number.span.end, end}, ""}};
    const std::string written(text_of(number.span));
    if (const auto remedy = remedy_of_memory(written, unit))
      return Diagnostic{Code::kSyntax,
                        Severity::kError,
                        {number.span.begin, end},
                        "memory is in MiB and has no unit",
                        "write " + *remedy,
                        Edit{{number.span.begin, end}, *remedy}};
    if (unit == "m")
      return Diagnostic{Code::kSyntax,
                        Severity::kError,
                        {number.span.begin, end},
                        "a duration has no blank in it",
                        "write " + written + "min for minutes, or " + written + "ms"};
    const std::string meant(duration_unit(unit));
    if (meant.empty()) return std::nullopt;
    return Diagnostic{Code::kSyntax,
                      Severity::kError,
                      {number.span.begin, end},
                      "a duration has no blank in it",
                      "write " + written + meant,
                      Edit{{number.span.end, end}, meant}};
  }

  std::nullopt_t value_is_missing(const Token& token) {
    if (token.is("&&") || token.is("||") || token.is("="))
      return fail(Code::kSyntax, token.span,
                  "a value is missing in front of '" + std::string(token.text) + "'",
                  "write it, or remove the '" + std::string(token.text) + "'");
    return fail(
        Code::kSyntax, token.span, "a value is missing here",
        "write a number, true or false, a \"text\", a signal, a constant or a function call");
  }

  // A topic has no value by itself.
  std::nullopt_t topic_for_value(const Token& slash) {
    const syntax::Name rest = scanner_.next_name();
    if (rest.text.empty() || rest.span.begin != slash.span.end) return value_is_missing(slash);
    const std::string written = "/" + rest.text;
    const auto dot = written.find('.');  // a topic's name has none: a field follows
    const std::string topic = written.substr(0, dot);
    const std::string field = dot == std::string::npos ? "field" : written.substr(dot + 1);
    return fail(Code::kSyntax, {slash.span.begin, rest.span.end}, "'" + written + "' is no value",
                "declare a field of its messages, SIGNAL name TOPIC " + topic + " FIELD " + field +
                    ", and write its name here; or read when messages come: age(" + topic +
                    "), rate(" + topic + ") or phi(" + topic + ")");
  }

  // Whether a value begins here, where none may stand behind a name.
  static bool continues(const Token& token) {
    return token.kind == Token::Kind::kIdentifier || token.is("(") || token.is("!");
  }

  std::optional<Expression> parenthesis(const Token& open, int depth) {
    if (depth >= kMaxNesting) return too_deep();
    auto inner = conditional(depth + 1);
    if (!inner) return std::nullopt;
    const Token close = scanner_.next();
    if (close.kind == Token::Kind::kBad) return bad(close);
    if (close.kind == Token::Kind::kIdentifier) return stray_word(close);
    if (!close.is(")")) return not_closed(open, close.kind, inner->span.end);
    inner->span = {open.span.begin, close.span.end};
    return inner;
  }

  // Behind a value in parentheses.
  std::nullopt_t stray_word(const Token& word) {
    const std::string written(word.text);
    return fail(Code::kSyntax, word.span, "unexpected '" + written + "' after a value",
                upper_case(written) == "IF" || upper_case(written) == "ELSE"
                    ? "to choose between two values, write condition ? one : other"
                    : "remove it, or write an operator or a ')' in front of it");
  }

  // "age(Image /robot/image)": one name too many. Reported; false: a parenthesis is missing.
  bool has_stray_name(const FunctionInfo& function, const Expression& first) {
    Scanner ahead = scanner_.ahead();
    const syntax::Name name = ahead.next_name();
    if (!name.text.starts_with('/') || !ahead.peek().is(")")) return false;
    fail(Code::kSyntax, name.span, "unexpected second name after '" + first.name.text + "'",
         "usage: " + std::string(function.usage));
    return true;
  }

  std::optional<Expression> call(Expression e, int depth) {
    const FunctionInfo* function = find_function(e.name.text);
    if (function == nullptr) {
      const std::string near = meant_function(e.name.text);
      return fail(Code::kUnknownFunction, e.name.span, "there is no function '" + e.name.text + "'",
                  near.empty() ? "known functions: rate age phi loss alive lifecycle parameter "
                                 "level mean min max stddev "
                                 "changed isnan frozen cpu memory goals goal_age logs abs pow sqrt"
                               : "did you mean '" + near + "'?",
                  replacement(e.name.span, near));
    }
    if (depth >= kMaxNesting) return too_deep();
    e.kind = Kind::kCall;
    const Token open = scanner_.next();
    while (!scanner_.peek().is(")")) {
      const bool is_behind_operand =
          !e.children.empty() && binary_operator(scanner_.peek()) != nullptr;
      if (is_behind_operand && has_stray_name(*function, e.children.back())) return std::nullopt;
      if (is_behind_operand) return not_closed(open, Token::Kind::kEnd, e.children.back().span.end);
      if (!e.children.empty() &&
          !expect(",", "',' or ')'", "usage: " + std::string(function->usage)))
        return std::nullopt;
      auto argument = this->argument(*function, e.children.size(), depth);
      if (!argument) return std::nullopt;
      e.children.push_back(std::move(*argument));
      if (scanner_.at_end()) return not_closed(open, Token::Kind::kEnd, e.children.back().span.end);
    }
    e.span.end = scanner_.next().span.end;
    if (e.children.size() < function->min_arguments ||
        e.children.size() > function->max_arguments) {
      if (auto slip = parameter_behind_dot(e)) return fail(std::move(*slip));
      return fail(Code::kArguments, e.span, "wrong number of arguments for " + e.name.text,
                  "usage: " + std::string(function->usage));
    }
    return e;
  }

  // "parameter(camera.gain)"
  static std::optional<Diagnostic> parameter_behind_dot(const Expression& call) {
    if (call.name.text != "parameter" || call.children.size() != 1) return std::nullopt;
    const syntax::Name& name = call.children[0].name;
    const auto dot = name.text.find('.');
    if (dot == std::string::npos || !is_component_reference(name.text.substr(0, dot)))
      return std::nullopt;
    const std::string meant = name.text.substr(0, dot) + ", " + name.text.substr(dot + 1);
    return Diagnostic{Code::kArguments,
                      Severity::kError,
                      name.span,
                      "a component and its parameter stand apart",
                      "write parameter(" + meant + ")",
                      Edit{name.span, meant}};
  }

  static std::string meant_function(std::string_view word) {
    std::string lower(word);
    std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
    if (find_function(lower) != nullptr) return lower;
    const std::string_view foreign = function_of_other_tools(lower);
    return foreign.empty() ? closest(lower, function_names()) : std::string(foreign);
  }

  std::optional<Expression> argument(const FunctionInfo& function, std::size_t index, int depth) {
    const bool is_name =
        index < function.arguments.size() && function.arguments[index] != Argument::kExpression;
    if (!is_name) return conditional(depth + 1);
    Expression e;
    e.kind = Kind::kName;
    const std::uint32_t at = scanner_.taken();
    e.name = scanner_.next_name();
    e.span = e.name.span;
    if (const Span next{at, at + 2}; e.name.text.empty() && text_of(next) == "//")
      return fail(Code::kSyntax, next, "'//' begins a comment", "write one '/'", Edit{next, "/"});
    if (e.name.text.empty()) {
      return fail(Code::kSyntax, e.span, "a name is missing here",
                  "usage: " + std::string(function.usage));
    }
    const Token& from = scanner_.peek();
    if (function.arguments[index] != Argument::kTopic || upper_case(from.text) != "FROM") return e;
    if (from.text != "FROM")
      return fail(Code::kSyntax, from.span, "'" + std::string(from.text) + "' is no word here",
                  "did you mean FROM?", Edit{from.span, "FROM"});
    scanner_.next();
    Expression publisher;
    publisher.kind = Kind::kName;
    publisher.name = scanner_.next_name();
    publisher.span = publisher.name.span;
    if (publisher.name.text.empty())
      return fail(
          Code::kSyntax, publisher.span, "a component is missing here",
          "write the component or the node that publishes it: " + e.name.text + " FROM camera");
    e.span.end = publisher.span.end;
    e.children.push_back(std::move(publisher));
    return e;
  }

  bool expect(std::string_view symbol, std::string_view what, std::string remedy = "") {
    const Token token = scanner_.next();
    if (token.is(symbol)) return true;
    if (token.kind == Token::Kind::kBad)
      bad(token);
    else
      fail(Code::kSyntax, token.span, "expected " + std::string(what), std::move(remedy));
    return false;
  }

  std::nullopt_t bad(const Token& token) {
    auto [cause, fix, remedy] = complaint_about(token);
    if (remedy.empty() && token.flaw == Token::Flaw::kNumber) {
      remedy = "a unit is one of ns, us, ms, s, min and h, as in 500ms";
      const auto number =
          std::get<std::string_view>(token.literal).substr(0, token.span.end - token.span.begin);
      const auto end = number.find_first_not_of(".0123456789");
      if (end != std::string_view::npos && is_physical_unit(number.substr(end))) {
        remedy = "only durations have a unit: write " + std::string(number.substr(0, end));
        fix = Edit{token.span, std::string(number.substr(0, end))};
      }
      if (end != std::string_view::npos && is_hertz(number.substr(end))) {
        remedy = "rates are in Hz and have no unit: write " + std::string(number.substr(0, end));
        fix = Edit{token.span, std::string(number.substr(0, end))};
      }
      if (end != std::string_view::npos) {
        if (const auto meant = remedy_of_memory(number.substr(0, end), number.substr(end))) {
          remedy = "memory is in MiB and has no unit: write " + *meant;
          fix = Edit{token.span, *meant};
        }
      }
    }
    const std::string_view written = text_of(token.span);
    if (const std::string name = name_in_braces(token); !name.empty()) {
      remedy = "write " + name + " without the braces";
      fix = Edit{{token.span.begin, token.span.begin + static_cast<std::uint32_t>(name.size()) + 2},
                 name};
    } else if (written == "{" || written == "[")
      remedy = "write parentheses: ( and )";
    return fail(Code::kBadToken, token.span, cause, remedy, fix);
  }

  static bool is_physical_unit(std::string_view unit) {
    constexpr auto kUnits = std::to_array<std::string_view>(
        {"C",  "F",  "f",   "K",   "V",   "mV", "A",  "mA", "W",  "m",  "cm",
         "mm", "km", "deg", "rad", "rpm", "N",  "Nm", "kg", "dB", "dBm"});
    return std::ranges::find(kUnits, unit) != kUnits.end();
  }

  // "{limit}"; empty: no such name begins there.
  std::string name_in_braces(const Token& brace) const {
    constexpr std::uint32_t kMost = 255;
    const std::string_view text = text_of({brace.span.begin, brace.span.begin + kMost});
    const std::size_t length = hole_length(text);
    return length > 2 ? std::string(text.substr(1, length - 2)) : "";
  }

  // The number in MiB; nothing: `unit` is none of memory.
  static std::optional<std::string> remedy_of_memory(std::string_view number,
                                                     std::string_view unit) {
    const std::string upper = upper_case(unit);
    const bool is_mebi = upper == "MB" || upper == "MIB" || unit == "M";
    const bool is_gibi = upper == "GB" || upper == "GIB" || unit == "G";
    if (is_mebi) return std::string(number);
    double gibi = 0;
    const char* end = number.data() + number.size();
    if (!is_gibi || std::from_chars(number.data(), end, gibi).ec != std::errc())
      return std::nullopt;
    return std::to_string(static_cast<std::int64_t>(gibi * 1024));
  }

  std::string_view text_of(Span span) const { return scanner_.text(span); }

  // `next` is what stands where the ')' was missed, `end` where it would have come.
  std::nullopt_t not_closed(const Token& open, Token::Kind next, std::uint32_t end) {
    std::optional<Edit> fix;
    if (text_of({end, end + 2}) == "//")
      return fail(Code::kSyntax, {end, end + 2},
                  "'//' begins a comment, so this '(' is never closed", "write one '/'",
                  Edit{{end, end + 2}, "/"});
    if (next == Token::Kind::kEnd) fix = {{end, end}, ")"};
    return fail(Code::kSyntax, open.span, "this '(' is never closed", "add a ')'", std::move(fix));
  }

  std::nullopt_t too_deep() {
    return fail(Code::kTooDeep, scanner_.rest(), "this expression is nested too deeply",
                "split it into several rules, or name parts of it with CONST");
  }

  std::nullopt_t too_long() {
    return fail(
        Code::kTooDeep, scanner_.peek().span,
        "this expression has more than " + std::to_string(kMaxNesting) + " operators in a row",
        "split it into several rules, or put parts of it in parentheses");
  }

  std::nullopt_t fail(Diagnostic diagnostic) {
    diagnostics_.push_back(std::move(diagnostic));
    return std::nullopt;
  }

  std::nullopt_t fail(Code code, Span span, std::string cause, std::string remedy,
                      std::optional<Edit> fix = {}) {
    diagnostics_.push_back(
        {code, Severity::kError, span, std::move(cause), std::move(remedy), std::move(fix)});
    return std::nullopt;
  }

  Scanner& scanner_;
  std::vector<Diagnostic>& diagnostics_;
};

}  // namespace

std::optional<syntax::Expression> parse_expression(Scanner& scanner,
                                                   std::vector<Diagnostic>& diagnostics) {
  return ExpressionParser(scanner, diagnostics).conditional(0);
}

}  // namespace culprit
