#include "language/expression_parser.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <string>
#include <utility>

#include "base/closest.h"
#include "language/foreign_operators.h"
#include "language/foreign_units.h"
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
        if (auto slip = doubled_operator(op, second)) return fail(std::move(*slip));
      }
      if (auto slip = per_second(*left, op, scanner_)) return fail(std::move(*slip));
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
    if (auto slip = foreign_operator(*left, scanner_)) return fail(std::move(*slip));
    return left;
  }

  static bool begins_value(const Token& token) {
    return token.kind != Token::Kind::kEnd &&
           (token.kind != Token::Kind::kSymbol || token.is("(") || token.is("-") || token.is("+") ||
            token.is("!"));
  }

  std::nullopt_t unfinished(const Token& op) {
    return fail(Code::kSyntax, op.span, "a value is missing behind '" + std::string(op.text) + "'",
                "write the other side; a statement is one line");
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
          const auto blank = unit_behind_blank(token, unit, scanner_);
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
            is_before_condition(upper) && continues(scanner_.peek()) && !scanner_.peek().is("(")) {
          return fail(Code::kSyntax, token.span,
                      "unexpected '" + std::string(token.text) + "' before a condition",
                      "remove it", Edit{{token.span.begin, scanner_.position()}, ""});
        }
        if (is_reminder(token.text))
          return fail(Code::kPlaceholder, token.span,
                      "'" + std::string(token.text) + "' stands for something of yours",
                      "write the condition or the value in its place");
        if (auto slip = letter_before_text(token, scanner_)) return fail(std::move(*slip));
        e.kind = Kind::kName;
        e.name = {std::string(token.text), token.span};
        if (auto slip = call_without_parentheses(e, scanner_)) return fail(std::move(*slip));
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

  // A word that other languages put in front of a condition.
  static bool is_before_condition(std::string_view upper) {
    return upper == "IF" || upper == "WHEN" || upper == "UNLESS" || upper == "SELECT" ||
           upper == "WHERE" || upper == "ASSERT";
  }

  std::nullopt_t value_is_missing(const Token& token) {
    const std::string written(token.text);
    if (token.is("=") || (binary_operator(token) != nullptr && !token.is("/")))
      return fail(Code::kSyntax, token.span, "a value is missing in front of '" + written + "'",
                  scanner_.at_end() ? "write the whole condition on this line"
                                    : "write it, or remove the '" + written + "'");
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
    if (function == nullptr) return unknown_function(e.name);
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

  std::nullopt_t unknown_function(const syntax::Name& name) {
    const std::string cause = "there is no function '" + name.text + "'";
    const std::string_view foreign = remedy_of_foreign_function(lower_case(name.text));
    if (!foreign.empty())
      return fail(Code::kUnknownFunction, name.span, cause, std::string(foreign));
    const std::string near = meant_function(name.text);
    return fail(Code::kUnknownFunction, name.span, cause,
                near.empty() ? "known functions: rate age phi loss alive lifecycle parameter "
                               "level mean min max stddev "
                               "changed isnan frozen cpu memory goals goal_age logs abs pow sqrt"
                             : "did you mean '" + near + "'?",
                replacement(name.span, near));
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

  static std::string lower_case(std::string_view word) {
    std::string lower(word);
    std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
    return lower;
  }

  static std::string meant_function(std::string_view word) {
    const std::string lower = lower_case(word);
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
      UnitSlip slip = slip_of_unit(token);
      remedy = std::move(slip.remedy);
      if (slip.fix) fix = std::move(slip.fix);
    }
    const std::string_view written = text_of(token.span);
    if (const std::string name = name_in_braces(token); !name.empty()) {
      remedy = "write " + name + " without the braces";
      fix = Edit{{token.span.begin, token.span.begin + static_cast<std::uint32_t>(name.size()) + 2},
                 name};
    } else if (written == "{" || written == "[") {
      remedy = "write parentheses: ( and )";
    } else if (written == "$" && !scanner_.allows_holes()) {
      remedy = "remove it: a name stands by itself; braces name a parameter of a TEMPLATE";
      fix = Edit{token.span, ""};
    }
    return fail(Code::kBadToken, token.span, cause, remedy, fix);
  }

  // "{limit}"; empty: no such name begins there.
  std::string name_in_braces(const Token& brace) const {
    constexpr std::uint32_t kMost = 255;
    const std::string_view text = text_of({brace.span.begin, brace.span.begin + kMost});
    const std::size_t length = hole_length(text);
    return length > 2 ? std::string(text.substr(1, length - 2)) : "";
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
