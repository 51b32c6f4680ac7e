#include "import/expression_reader.h"

#include <array>

#include "language/expression_parser.h"

namespace culprit::foreign {
namespace {

using syntax::Operator;
using Kind = Expression::Kind;

struct BinaryOperator {
  std::string_view symbol;
  Operator op;
  int precedence;
};
constexpr std::array kBinary = {
    BinaryOperator{"||", Operator::kOr, 0},       BinaryOperator{"&&", Operator::kAnd, 0},
    BinaryOperator{"==", Operator::kEqual, 1},    BinaryOperator{"!=", Operator::kNotEqual, 1},
    BinaryOperator{"<", Operator::kLess, 1},      BinaryOperator{"<=", Operator::kLessEqual, 1},
    BinaryOperator{">", Operator::kGreater, 1},   BinaryOperator{">=", Operator::kGreaterEqual, 1},
    BinaryOperator{"+", Operator::kAdd, 2},       BinaryOperator{"-", Operator::kSubtract, 2},
    BinaryOperator{"*", Operator::kMultiply, 3},  BinaryOperator{"/", Operator::kDivide, 3},
    BinaryOperator{"%", Operator::kRemainder, 3},
};

class ExpressionReader {
 public:
  ExpressionReader(Scanner& scanner, FileReader& reader, std::vector<std::string>& notes)
      : scanner_(scanner), reader_(reader), notes_(notes) {}

  std::optional<Expression> read(int min_precedence, int depth) {
    auto left = power(depth);
    if (!left) return std::nullopt;
    bool is_or = false;
    int length = 0;
    while (const BinaryOperator* found = binary_operator()) {
      if (found->precedence < min_precedence) break;
      // A chain nests to the left as deep as it is long.
      if (++length + depth > kMaxNesting) return too_deep();
      if (found->op == Operator::kAnd && is_or)
        note("the reference gives && and || the same precedence; the parentheses say so");
      if (found->op == Operator::kRemainder)
        note("the reference knows no %; it drops the text from there on");
      is_or = found->op == Operator::kOr;
      scanner_.next();
      auto right = read(found->precedence + 1, depth + length);
      if (!right) return std::nullopt;
      left = binary(found->op, std::move(*left), std::move(*right));
    }
    return left;
  }

 private:
  const BinaryOperator* binary_operator() const {
    const Token& token = scanner_.peek();
    if (token.kind != Token::Kind::kSymbol) return nullptr;
    for (const BinaryOperator& candidate : kBinary) {
      if (candidate.symbol == token.text) return &candidate;
    }
    return nullptr;
  }

  // unary ('^' unary)*, and a number before "(".
  std::optional<Expression> power(int depth) {
    auto left = unary(depth, true);
    int length = 0;
    while (left) {
      const bool is_power = reader_.source().text(scanner_.peek().span) == "^";
      const bool multiplies = is_number(*left) && scanner_.peek().is("(");
      if (!is_power && !multiplies) break;
      if (++length + depth > kMaxNesting) return too_deep();
      if (is_power) scanner_.next();
      if (multiplies) note("a number before '(' multiplies in the reference; * is written out");
      auto right = unary(depth + length, false);
      if (!right) return std::nullopt;
      left = is_power ? call_pow(std::move(*left), std::move(*right))
                      : binary(Operator::kMultiply, std::move(*left), std::move(*right));
    }
    return left;
  }

  std::optional<Expression> unary(int depth, bool at_start) {
    const Token token = scanner_.peek();
    if (!token.is("!") && !token.is("-") && !token.is("+")) return primary(depth);
    if (depth >= kMaxNesting) return too_deep();
    if (!at_start)
      note("the reference cannot read this sign behind '^' or another sign; it is read as written");
    scanner_.next();
    auto operand = unary(depth + 1, false);
    if (!operand || token.is("+")) return operand;
    Expression e;
    e.kind = Kind::kUnary;
    e.op = token.is("!") ? Operator::kNot : Operator::kNegate;
    e.children.push_back(std::move(*operand));
    return e;
  }

  std::optional<Expression> primary(int depth) {
    const Token token = scanner_.next();
    Expression e;
    switch (token.kind) {
      case Token::Kind::kNumber:
        e.literal = token.value();
        note_number(token);
        return e;
      case Token::Kind::kString:
        e.literal = token.value();
        return e;
      case Token::Kind::kIdentifier:
        return name(token);
      case Token::Kind::kSymbol:
        if (token.is("(")) return parenthesis(token, depth);
        break;
      case Token::Kind::kBad:
        return fail(token.span, complaint_about(token).cause);
      case Token::Kind::kDuration:
      case Token::Kind::kEnd:
        break;
    }
    return fail(token.span, "a value is missing here");
  }

  std::optional<Expression> name(const Token& token) {
    Expression e;
    if (token.text == "true" || token.text == "false") {
      e.literal = token.value();
      return e;
    }
    e.kind = Kind::kName;
    e.name = {std::string(token.text), token.span};
    if (scanner_.peek().is("("))
      return fail(token.span,
                  "the reference has no functions, so '" + e.name.text + "(' is no text of it");
    return e;
  }

  std::optional<Expression> parenthesis(const Token& open, int depth) {
    if (depth >= kMaxNesting) return too_deep();
    if (scanner_.peek().is("-"))
      note("the reference cannot read a '-' behind '('; it is read as written");
    auto inner = read(0, depth + 1);
    if (!inner) return std::nullopt;
    if (!scanner_.next().is(")")) return fail(open.span, "this '(' is never closed");
    return inner;
  }

  // Its numbers are digits, or digits, a point and digits.
  void note_number(const Token& token) {
    const std::string_view text = reader_.source().text(token.span);
    if (text.find_first_of("eE") != std::string_view::npos || text.front() == '.') {
      note("the reference does not read " + std::string(text) + " as one number");
    } else if (text.back() == '.' && !scanner_.at_end()) {
      note("the reference drops what follows " + std::string(text.substr(0, text.size() - 1)) +
           " in this line; it is read as written");
    }
  }

  static bool is_number(const Expression& e) {
    return e.kind == Kind::kLiteral && (std::holds_alternative<std::int64_t>(*e.literal) ||
                                        std::holds_alternative<double>(*e.literal));
  }

  static Expression call_pow(Expression base, Expression exponent) {
    Expression e = binary(Operator::kMultiply, std::move(base), std::move(exponent));
    e.kind = Kind::kCall;
    e.name.text = "pow";
    return e;
  }

  void note(std::string text) { notes_.push_back(std::move(text)); }
  std::nullopt_t too_deep() {
    return fail(scanner_.rest(), "this expression is nested too deeply");
  }
  std::nullopt_t fail(Span span, const std::string& cause) {
    reader_.fail(span, cause,
                 "an expression is made of numbers, true, false, \"texts\", names, operators and "
                 "parentheses");
    return std::nullopt;
  }

  Scanner& scanner_;
  FileReader& reader_;
  std::vector<std::string>& notes_;
};

}  // namespace

Expression binary(Operator op, Expression left, Expression right) {
  Expression e;
  e.kind = Kind::kBinary;
  e.op = op;
  e.children.push_back(std::move(left));
  e.children.push_back(std::move(right));
  return e;
}

std::optional<Expression> read_expression(Scanner& scanner, FileReader& reader,
                                          std::vector<std::string>& notes) {
  return ExpressionReader(scanner, reader, notes).read(0, 0);
}

}  // namespace culprit::foreign
