#include "import/expression_text.h"

#include "base/value.h"

namespace culprit::foreign {
namespace {

using syntax::Expression;
using syntax::Operator;
using Kind = Expression::Kind;

int precedence(Operator op) {
  switch (op) {
    case Operator::kOr:
      return 1;
    case Operator::kAnd:
      return 2;
    case Operator::kEqual:
    case Operator::kNotEqual:
      return 3;
    case Operator::kLess:
    case Operator::kLessEqual:
    case Operator::kGreater:
    case Operator::kGreaterEqual:
      return 4;
    case Operator::kAdd:
    case Operator::kSubtract:
      return 5;
    case Operator::kMultiply:
    case Operator::kDivide:
    case Operator::kRemainder:
      return 6;
    case Operator::kNot:
    case Operator::kNegate:
    case Operator::kPlus:
      return 7;
  }
  return 7;
}

class ExpressionWriter {
 public:
  explicit ExpressionWriter(const Meanings& meanings) : meanings_(meanings) {}

  struct Text {
    std::string text;
    int precedence;
    bool is_whole;
  };

  Text write(const Expression& e) const {
    constexpr int kAtom = 8;
    switch (e.kind) {
      case Kind::kLiteral:
        return {literal_text(*e.literal), kAtom, std::holds_alternative<std::int64_t>(*e.literal)};
      case Kind::kName: {
        Meaning meaning = meanings_(e.name.text);
        return {std::move(meaning.text), kAtom, meaning.is_whole};
      }
      case Kind::kUnary: {
        const Text operand = write(e.children[0]);
        return {std::string(symbol(e.op)) + grouped(operand, precedence(e.op)), precedence(e.op),
                operand.is_whole};
      }
      case Kind::kBinary:
        return binary(e);
      case Kind::kCall:  // pow is the only one that the reference has an operator for
        return {"pow(" + write(e.children[0]).text + ", " + write(e.children[1]).text + ")", kAtom,
                false};
      case Kind::kConditional:
        break;  // the reference has none
    }
    return {"", kAtom, false};
  }

 private:
  Text binary(const Expression& e) const {
    const int level = precedence(e.op);
    const Text left = write(e.children[0]);
    const Text right = write(e.children[1]);
    const bool is_whole = left.is_whole && right.is_whole;
    const bool divides_whole = is_whole && e.op == Operator::kDivide;
    std::string text = divides_whole ? "1.0 * " + grouped(left, level + 1) : grouped(left, level);
    text += " " + std::string(symbol(e.op)) + " " + grouped(right, level + 1);
    return {std::move(text), level, is_whole && !divides_whole};
  }

  static std::string grouped(const Text& text, int at_least) {
    return text.precedence < at_least ? "(" + text.text + ")" : text.text;
  }

  const Meanings& meanings_;
};

}  // namespace

std::string expression_text(const Expression& expression, const Meanings& meanings) {
  return ExpressionWriter(meanings).write(expression).text;
}

std::string literal_text(const syntax::Literal& literal) {
  if (const auto* b = std::get_if<bool>(&literal)) return to_string(Value(*b));
  if (const auto* i = std::get_if<std::int64_t>(&literal)) return to_string(Value(*i));
  if (const auto* d = std::get_if<double>(&literal)) return to_string(Value(*d));
  if (const auto* s = std::get_if<std::string>(&literal)) return to_string(Value(*s));
  return to_string(std::get<Duration>(literal));
}

}  // namespace culprit::foreign
