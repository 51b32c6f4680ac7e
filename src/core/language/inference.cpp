#include <variant>

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

// The type of an expression as far as it is inferred: unknown, the type, or the variable that it
// shares.
using Inferred = std::variant<std::monostate, Type, TypeClasses::Variable>;

bool is_duration(const Inferred& inferred) { return inferred == Inferred(Type::kDuration); }

class Inference {
 public:
  explicit Inference(Symbols& symbols) : symbols_(symbols) {}

  Inferred infer(const Expression& e, std::optional<Type> wanted) {
    switch (e.kind) {
      case Kind::kLiteral:
        return type_of_literal(*e.literal);
      case Kind::kName:
        return name(e, wanted);
      case Kind::kUnary:
        if (e.op == Operator::kNot) return infer(e.children[0], Type::kBool);
        return infer(e.children[0], Type::kDouble);
      case Kind::kBinary:
        return binary(e);
      case Kind::kConditional: {
        infer(e.children[0], Type::kBool);
        const Inferred yes = infer(e.children[1], wanted);
        const Inferred no = infer(e.children[2], wanted);
        return alike(yes, no);
      }
      case Kind::kCall:
        return call(e, wanted);
    }
    return {};
  }

 private:
  Inferred name(const Expression& e, std::optional<Type> wanted) {
    if (const auto* constant = symbols_.constant(e.name.text)) {
      if (!constant->broken) return type_of_literal(constant->value);
      return wanted ? Inferred(*wanted) : Inferred();
    }
    return variable(symbols_.type_variable(symbols_.signal(e.name)), wanted);
  }

  // A signal or a parameter takes the type that is wanted of it.
  Inferred variable(TypeClasses::Variable v, std::optional<Type> wanted) {
    if (wanted) symbols_.types().learn(v, *wanted);
    const auto type = symbols_.types().type_of(v);
    return type ? Inferred(*type) : Inferred(v);
  }

  // Both are of one type, which is what this gives as far as it is known.
  Inferred alike(const Inferred& a, const Inferred& b) {
    const auto* x = std::get_if<TypeClasses::Variable>(&a);
    const auto* y = std::get_if<TypeClasses::Variable>(&b);
    if (x != nullptr && y != nullptr) {
      symbols_.types().unify(*x, *y);
      return a;
    }
    if (x != nullptr) return taught(*x, b);
    if (y != nullptr) return taught(*y, a);
    return std::holds_alternative<Type>(a) ? a : b;
  }

  Inferred taught(TypeClasses::Variable v, const Inferred& by) {
    const Type* type = std::get_if<Type>(&by);
    return variable(v, type != nullptr ? std::optional(*type) : std::nullopt);
  }

  Inferred binary(const Expression& e) {
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
        const Inferred a = infer(left, std::nullopt);
        alike(a, infer(right, std::nullopt));
        return Type::kBool;
      }
      default:
        break;
    }
    const Inferred a = infer(left, Type::kDouble);
    const Inferred b = infer(right, Type::kDouble);
    if (e.op == Operator::kDivide && is_duration(a) && is_duration(b)) return Type::kDouble;
    if (is_duration(a) || is_duration(b)) return Type::kDuration;
    return a == Inferred(Type::kInt) && b == a ? Type::kInt : Type::kDouble;
  }

  Inferred call(const Expression& e, std::optional<Type> wanted) {
    const FunctionInfo* function = find_function(e.name.text);
    switch (function->function) {
      case Function::kRate:
      case Function::kPhi:
      case Function::kLoss:
        return Type::kDouble;
      case Function::kAge:
        return Type::kDuration;
      case Function::kGoals:
      case Function::kLogs:
        infer(e.children[2], Type::kDuration);
        return Type::kInt;
      case Function::kGoalAge:
        return Type::kDuration;
      case Function::kCpu:
      case Function::kMemory:
        return Type::kDouble;
      case Function::kAlive:
        return Type::kBool;
      case Function::kLifecycle:
        return Type::kString;
      case Function::kLevel:
        return Type::kInt;
      case Function::kParameter: {
        const ComponentId component = symbols_.component(e.children[0].name);
        const ParameterId parameter = symbols_.parameter(component, e.children[1].name.text);
        return variable(symbols_.type_variable(parameter), wanted);
      }
      case Function::kChanged:
        infer(e.children[0], std::nullopt);
        return Type::kBool;
      case Function::kFrozen:
        infer(e.children[0], std::nullopt);
        infer(e.children[1], Type::kDuration);
        return Type::kBool;
      case Function::kIsNan:
        infer(e.children[0], Type::kDouble);
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
        const Inferred a = infer(e.children[0], Type::kDouble);
        const Inferred b = infer(e.children[1], Type::kDouble);
        return a == b ? a : Type::kDouble;
      }
      case Function::kPow:
      case Function::kSqrt:
        for (const Expression& child : e.children) infer(child, Type::kDouble);
        return Type::kDouble;
    }
    return {};
  }

  Symbols& symbols_;
};

}  // namespace

void infer_types(const Expression& expression, std::optional<Type> wanted, Symbols& symbols) {
  Inference(symbols).infer(expression, wanted);
}

}  // namespace culprit
