#include "language/functions.h"
#include "language/typing.h"

namespace culprit {
namespace {

using syntax::Expression;
using syntax::Operator;
using Kind = Expression::Kind;

Type type_of_literal(const syntax::Literal& literal) {
  constexpr Type kTypes[] = {Type::kBool, Type::kInt, Type::kDouble, Type::kString,
                             Type::kDuration};
  return kTypes[literal.index()];
}

class Inference {
 public:
  Inference(Symbols& symbols, bool& learned) : symbols_(symbols), learned_(learned) {}

  std::optional<Type> infer(const Expression& e, std::optional<Type> wanted) {
    switch (e.kind) {
      case Kind::kLiteral:
        return type_of_literal(e.literal);
      case Kind::kName:
        return name(e, wanted);
      case Kind::kUnary:
        if (e.op == Operator::kNot) return infer(e.children[0], Type::kBool);
        return infer(e.children[0], Type::kDouble);
      case Kind::kBinary:
        return binary(e);
      case Kind::kConditional: {
        infer(e.children[0], Type::kBool);
        const auto yes = infer(e.children[1], wanted);
        const auto no = infer(e.children[2], yes ? yes : wanted);
        return yes ? yes : infer(e.children[1], no);
      }
      case Kind::kCall:
        return call(e, wanted);
    }
    return std::nullopt;
  }

 private:
  std::optional<Type> name(const Expression& e, std::optional<Type> wanted) {
    if (const auto* constant = symbols_.constant(e.name.text)) {
      return constant->broken ? wanted : type_of_literal(constant->value);
    }
    return variable(symbols_.type_of(symbols_.signal(e.name)), wanted);
  }

  // A signal or a parameter takes the type that is wanted of it; all numbers are doubles, and none
  // are durations.
  std::optional<Type> variable(std::optional<Type>& type, std::optional<Type> wanted) {
    if (type || !wanted || *wanted == Type::kDuration) return type;
    type = *wanted == Type::kInt ? Type::kDouble : *wanted;
    learned_ = true;
    return type;
  }

  std::optional<Type> binary(const Expression& e) {
    const Expression& left = e.children[0];
    const Expression& right = e.children[1];
    switch (e.op) {
      case Operator::kAnd:
      case Operator::kOr:
        infer(left, Type::kBool);
        infer(right, Type::kBool);
        return Type::kBool;
      case Operator::kEqual:
      case Operator::kNotEqual:
      case Operator::kLess:
      case Operator::kLessEqual:
      case Operator::kGreater:
      case Operator::kGreaterEqual: {
        const auto type = infer(left, std::nullopt);
        const auto other = infer(right, type);
        if (!type) infer(left, other);
        return Type::kBool;
      }
      default:
        break;
    }
    const auto a = infer(left, Type::kDouble);
    const auto b = infer(right, Type::kDouble);
    const bool durations = a == Type::kDuration && b == Type::kDuration;
    if (e.op == Operator::kDivide && durations) return Type::kDouble;
    if (a == Type::kDuration || b == Type::kDuration) return Type::kDuration;
    return a == Type::kInt && b == Type::kInt ? Type::kInt : Type::kDouble;
  }

  std::optional<Type> call(const Expression& e, std::optional<Type> wanted) {
    const FunctionInfo* function = find_function(e.name.text);
    switch (function->function) {
      case Function::kRate:
      case Function::kPhi:
        return Type::kDouble;
      case Function::kAge:
        return Type::kDuration;
      case Function::kAlive:
        return Type::kBool;
      case Function::kLifecycle:
        return Type::kString;
      case Function::kLevel:
        return Type::kInt;
      case Function::kParameter: {
        const ComponentId component = symbols_.component(e.children[0].name);
        return variable(symbols_.type_of(symbols_.parameter(component, e.children[1].name.text)),
                        wanted);
      }
      case Function::kChanged:
        infer(e.children[0], std::nullopt);
        return Type::kBool;
      case Function::kMean:
      case Function::kStddev:
        infer(e.children[0], Type::kDouble);
        infer(e.children[1], Type::kDuration);
        return Type::kDouble;
      case Function::kAbs:
        return infer(e.children[0], Type::kDouble);
      case Function::kMin:
      case Function::kMax: {
        const auto a = infer(e.children[0], Type::kDouble);
        const auto b = infer(e.children[1], Type::kDouble);
        return a == b ? a : Type::kDouble;
      }
      case Function::kPow:
      case Function::kSqrt:
        for (const Expression& child : e.children) infer(child, Type::kDouble);
        return Type::kDouble;
    }
    return std::nullopt;
  }

  Symbols& symbols_;
  bool& learned_;
};

}  // namespace

std::optional<Type> infer_types(const Expression& expression, std::optional<Type> wanted,
                                Symbols& symbols, bool& learned) {
  return Inference(symbols, learned).infer(expression, wanted);
}

}  // namespace culprit
