#include "language/expression_parser.h"

#include <array>

#include "language/functions.h"

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
    if (!yes || !expect(":", "':' and the value for 'otherwise'")) return std::nullopt;
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
      if (++length + depth > kMaxNesting) return too_deep();
      scanner_.next();
      auto right = binary(found->precedence + 1, depth + length);
      if (!right) return std::nullopt;
      Expression e;
      e.kind = Kind::kBinary;
      e.op = found->op;
      e.span = {left->span.begin, right->span.end};
      adopt(e, std::move(*left), std::move(*right));
      left = std::move(e);
    }
    return left;
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
        if (token.text == "not" && continues(scanner_.peek())) {
          return fail(Code::kSyntax, token.span, "'not' is no operator",
                      "write ! for 'not', as in !docked",
                      Edit{{token.span.begin, scanner_.position()}, "!"});
        }
        e.kind = Kind::kName;
        e.name = {std::string(token.text), token.span};
        return scanner_.peek().is("(") ? call(std::move(e), depth) : std::optional(std::move(e));
      case Token::Kind::kSymbol:
        if (token.is("(")) return parenthesis(token, depth);
        if (token.is("/")) return topic_for_value(token);
        break;
      case Token::Kind::kBad: {
        const auto [cause, fix] = complaint_about(token);
        const bool is_unclosed = token.flaw == Token::Flaw::kUnclosed;
        return fail(Code::kBadToken, token.span, cause,
                    is_unclosed ? "write a '\"' where the text ends" : "", fix);
      }
      case Token::Kind::kEnd:
        break;
    }
    return value_is_missing(token);
  }

  // "500 ms"
  std::optional<Diagnostic> unit_behind_blank(const Token& number, std::string_view unit) {
    if (!parse_duration("1" + std::string(unit))) return std::nullopt;
    const std::uint32_t begin = scanner_.position();
    const auto end = begin + static_cast<std::uint32_t>(unit.size());
    return Diagnostic{Code::kSyntax,
                      Severity::kError,
                      {number.span.begin, end},
                      "a duration has no blank in it",
                      "write the number and '" + std::string(unit) + "' as one word: 500ms",
                      Edit{{number.span.end, begin}, ""}};
  }

  std::nullopt_t value_is_missing(const Token& token) {
    return fail(
        Code::kSyntax, token.span, "a value is missing here",
        "write a number, true or false, a \"text\", a signal, a constant or a function call");
  }

  // A topic has no value by itself.
  std::nullopt_t topic_for_value(const Token& slash) {
    const syntax::Name rest = scanner_.next_name();
    if (rest.text.empty() || rest.span.begin != slash.span.end) return value_is_missing(slash);
    const std::string topic = "/" + rest.text;
    return fail(Code::kSyntax, {slash.span.begin, rest.span.end}, "'" + topic + "' is no value",
                "of a topic there are age(" + topic + "), rate(" + topic + ") and phi(" + topic +
                    "); a field of its messages is a SIGNAL: SIGNAL name TOPIC " + topic +
                    " FIELD field");
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
    if (!close.is(")")) return not_closed(open, close.kind, inner->span.end);
    inner->span = {open.span.begin, close.span.end};
    return inner;
  }

  std::optional<Expression> call(Expression e, int depth) {
    const FunctionInfo* function = find_function(e.name.text);
    if (function == nullptr) {
      const std::string near = closest(e.name.text, function_names());
      return fail(Code::kUnknownFunction, e.name.span, "there is no function '" + e.name.text + "'",
                  near.empty() ? "known functions: rate age phi loss alive lifecycle parameter "
                                 "level mean min max stddev "
                                 "changed isnan frozen cpu memory goals goal_age abs pow sqrt"
                               : "did you mean '" + near + "'?",
                  replacement(e.name.span, near));
    }
    if (depth >= kMaxNesting) return too_deep();
    e.kind = Kind::kCall;
    const Token open = scanner_.next();
    while (!scanner_.peek().is(")")) {
      if (!e.children.empty() && !expect(",", "',' or ')'")) return std::nullopt;
      auto argument = this->argument(*function, e.children.size(), depth);
      if (!argument) return std::nullopt;
      e.children.push_back(std::move(*argument));
      if (scanner_.at_end()) return not_closed(open, Token::Kind::kEnd, e.children.back().span.end);
    }
    e.span.end = scanner_.next().span.end;
    if (e.children.size() < function->min_arguments ||
        e.children.size() > function->max_arguments) {
      return fail(Code::kArguments, e.span, "wrong number of arguments for " + e.name.text,
                  "usage: " + std::string(function->usage));
    }
    return e;
  }

  std::optional<Expression> argument(const FunctionInfo& function, std::size_t index, int depth) {
    const bool is_name =
        index < function.arguments.size() && function.arguments[index] != Argument::kExpression;
    if (!is_name) return conditional(depth + 1);
    Expression e;
    e.kind = Kind::kName;
    e.name = scanner_.next_name();
    e.span = e.name.span;
    if (e.name.text.empty()) {
      return fail(Code::kSyntax, e.span, "a name is missing here",
                  "usage: " + std::string(function.usage));
    }
    if (function.arguments[index] != Argument::kTopic || scanner_.peek().text != "FROM") return e;
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

  bool expect(std::string_view symbol, std::string_view what) {
    const Token token = scanner_.next();
    if (token.is(symbol)) return true;
    fail(Code::kSyntax, token.span, "expected " + std::string(what), "");
    return false;
  }

  // `next` is what stands where the ')' was missed, `end` where it would have come.
  std::nullopt_t not_closed(const Token& open, Token::Kind next, std::uint32_t end) {
    std::optional<Edit> fix;
    if (next == Token::Kind::kEnd) fix = {{end, end}, ")"};
    return fail(Code::kSyntax, open.span, "this '(' is never closed", "add a ')'", std::move(fix));
  }

  std::nullopt_t too_deep() {
    return fail(Code::kTooDeep, scanner_.rest(), "this expression is nested too deeply",
                "split it into several rules, or name parts of it with CONST");
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
