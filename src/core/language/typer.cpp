#include "language/typer.h"

#include <algorithm>

#include "language/call_typing.h"
#include "language/functions.h"
#include "language/type_mismatch.h"

namespace culprit {
namespace {

using syntax::Expression;
using syntax::Operator;
using Kind = Expression::Kind;

Typed constant(Type type, Slot slot, std::string text = "") {
  Typed typed;
  typed.type = type;
  typed.constant = Constant{slot, std::move(text)};
  return typed;
}

Typed literal(const syntax::Literal& value) {
  if (const auto* b = std::get_if<bool>(&value)) return constant(Type::kBool, Slot::of(*b));
  if (const auto* i = std::get_if<std::int64_t>(&value)) return constant(Type::kInt, Slot::of(*i));
  if (const auto* d = std::get_if<double>(&value)) return constant(Type::kDouble, Slot::of(*d));
  if (const auto* duration = std::get_if<Duration>(&value))
    return constant(Type::kDuration, Slot::of(*duration));
  return constant(Type::kString, Slot::of(std::string_view()), std::get<std::string>(value));
}

// One instruction for whole numbers (and durations), one for doubles, one for texts, one for bools.
struct Family {
  Op exact, real, text, truth;
};
constexpr Op kNone = Op::kConstant;
constexpr Family kLess{Op::kLessInt, Op::kLessDouble, Op::kLessString, kNone};
constexpr Family kLessEqual{Op::kLessEqualInt, Op::kLessEqualDouble, Op::kLessEqualString, kNone};
constexpr Family kEqual{Op::kEqualInt, Op::kEqualDouble, Op::kEqualString, Op::kEqualBool};

const Family& family(Operator comparison) {
  switch (comparison) {
    case Operator::kEqual:
    case Operator::kNotEqual:
      return kEqual;
    case Operator::kLess:
    case Operator::kGreater:
      return kLess;
    default:
      return kLessEqual;
  }
}

Op member(const Family& family, Type type) {
  switch (type) {
    case Type::kBool:
      return family.truth;
    case Type::kInt:
    case Type::kDuration:
      return family.exact;
    case Type::kDouble:
      return family.real;
    case Type::kString:
      return family.text;
  }
  return kNone;
}

// "age /scan" is a division for the parser.
bool may_be_call(const Expression& e) {
  return e.op == Operator::kDivide && e.children[0].kind == Kind::kName &&
         e.children[1].kind == Kind::kName && find_function(e.children[0].name.text) != nullptr;
}

Op arithmetic_op(Operator op, bool exact) {
  switch (op) {
    case Operator::kAdd:
      return exact ? Op::kAddInt : Op::kAddDouble;
    case Operator::kSubtract:
      return exact ? Op::kSubtractInt : Op::kSubtractDouble;
    case Operator::kMultiply:
      return exact ? Op::kMultiplyInt : Op::kMultiplyDouble;
    case Operator::kDivide:
      return exact ? Op::kDivideInt : Op::kDivideDouble;
    case Operator::kRemainder:
      return exact ? Op::kRemainderInt : Op::kRemainderDouble;
    case Operator::kNot:
    case Operator::kNegate:
    case Operator::kPlus:
    case Operator::kLess:
    case Operator::kLessEqual:
    case Operator::kGreater:
    case Operator::kGreaterEqual:
    case Operator::kEqual:
    case Operator::kNotEqual:
    case Operator::kAnd:
    case Operator::kOr:
      break;
  }
  return kNone;
}

}  // namespace

bool is_exact(Type type) { return type == Type::kInt || type == Type::kDuration; }

bool make_alike(Typed& a, Typed& b) {
  if (a.type == b.type) return true;
  if (!is_numeric(a.type) || !is_numeric(b.type)) return false;
  Typed& whole = a.type == Type::kInt ? a : b;
  whole = *converted(std::move(whole), Type::kDouble);
  return true;
}

std::optional<Typed> Typer::type(const Expression& e) {
  auto typed = type_of(e);
  if (!typed) return typed;
  typed->span = e.span;
  // a != b is !(a == b) in one place.
  if (typed->op == Op::kNot && typed->children[0].span == Span{}) typed->children[0].span = e.span;
  return typed;
}

std::optional<Typed> Typer::type_of(const Expression& e) {
  switch (e.kind) {
    case Kind::kLiteral:
      return literal(*e.literal);
    case Kind::kName:
      return name(e);
    case Kind::kUnary:
      return unary(e);
    case Kind::kBinary:
      return binary(e);
    case Kind::kConditional:
      return conditional(e);
    case Kind::kCall:
      return type_call(e, *this);
  }
  return std::nullopt;
}

std::optional<Typed> Typer::name(const Expression& e) {
  if (const auto* constant = symbols_.constant(e.name.text)) {
    if (constant->broken) return std::nullopt;  // reported where it is defined
    return literal(constant->value);
  }
  if (symbols_.is_declared_component(e.name.text) && symbols_.is_looked_up(e.name.text)) {
    const std::string meant = "alive(" + e.name.text + ")";
    return fail(Code::kUnknownName, e.span, "'" + e.name.text + "' is a component, and no value",
                "write " + meant, Edit{e.span, meant});
  }
  const SignalId signal = symbols_.signal(e.name);
  const auto type = symbols_.type_of(signal);
  if (!type) return unknown_type(e);
  if (!is_part_of_call_) bare_.warn_of_bare_function(e);
  Input wanted;
  wanted.kind = Input::Kind::kSignal;
  wanted.signal = signal;
  return input(wanted, *type);
}

std::nullopt_t Typer::unknown_type(const Expression& e) {
  const std::string near = symbols_.forget_near_miss(e.name.text);
  if (!near.empty()) {
    return fail(Code::kUnknownName, e.span, "signal '" + e.name.text + "' is not declared",
                "did you mean '" + near + "'?", Edit{e.span, near});
  }
  if (names_broken_constant(whole_)) return std::nullopt;  // which would have told
  const std::string& name = e.name.text;
  if (const FunctionInfo* function = find_function(name);
      function != nullptr && symbols_.is_looked_up(name))
    return fail(Code::kUnknownType, e.span, "'" + name + "' lacks its parentheses",
                "usage of the function: " + std::string(function->usage));
  if (&e == &whole_ && symbols_.is_looked_up(name))
    return fail(Code::kUnknownType, e.span, "cannot infer the type of this value",
                "a text needs quotes: write \"" + name +
                    "\"; a constant is declared, as in CONST " + name + " = 5");
  const std::string declare =
      symbols_.is_looked_up(name) ? "declare it, as in CONST " + name + " = ..., or " : "";
  return fail(Code::kUnknownType, e.span, "cannot infer the type of this value",
              declare + "compare it with a constant; a text needs quotes: \"" + name + "\"");
}

Typed Typer::input(Input wanted, Type type) {
  wanted.type = type;
  Typed typed;
  typed.op = Op::kInput;
  typed.type = type;
  typed.input = symbols_.input(wanted);
  return typed;
}

std::optional<Typed> Typer::unary(const Expression& e) {
  auto operand = type(e.children[0]);
  if (!operand) return std::nullopt;
  const Type t = operand->type;
  if (e.op == Operator::kNot) {
    if (t == Type::kBool) return typed_node(Op::kNot, t, std::move(*operand));
    return fail(Code::kTypeMismatch, e.children[0].span,
                std::string("! needs true or false; this is ") + describe(t), "");
  }
  if (e.op == Operator::kPlus && (is_exact(t) || t == Type::kDouble)) return operand;
  if (is_exact(t)) return typed_node(Op::kNegateInt, t, std::move(*operand));
  if (t == Type::kDouble) return typed_node(Op::kNegateDouble, t, std::move(*operand));
  return fail(Code::kTypeMismatch, e.children[0].span,
              std::string(symbol(e.op)) + " needs a number; this is " + describe(t), "");
}

std::optional<Typed> Typer::conditional(const Expression& e) {
  auto condition = type(e.children[0]);
  if (!condition) return std::nullopt;
  if (condition->type != Type::kBool) {
    return fail(Code::kTypeMismatch, e.children[0].span,
                std::string("the condition of ?: must be true or false; this is ") +
                    describe(condition->type),
                "");
  }
  auto yes = type(e.children[1]);
  if (!yes) return std::nullopt;
  auto no = type(e.children[2]);
  if (!no || !make_alike(*yes, *no)) {
    if (no) mismatch(e, yes->type, no->type, "choose between");
    return std::nullopt;
  }
  const Type result = yes->type;
  return typed_node(Op::kSelect, result, std::move(*condition), std::move(*yes), std::move(*no));
}

std::optional<Typed> Typer::binary(const Expression& e) {
  if (is_comparison(e) && bare_.compares_with_nothing(e)) return std::nullopt;
  is_part_of_call_ = may_be_call(e);
  auto left = type(e.children[0]);
  is_part_of_call_ = false;
  if (!left) return std::nullopt;
  auto right = type(e.children[1]);
  if (!right || is_call_without_parentheses(e)) return std::nullopt;
  switch (e.op) {
    case Operator::kAnd:
      return logic(e, Op::kAnd, std::move(*left), std::move(*right));
    case Operator::kOr:
      return logic(e, Op::kOr, std::move(*left), std::move(*right));
    case Operator::kLess:
    case Operator::kLessEqual:
    case Operator::kGreater:
    case Operator::kGreaterEqual:
    case Operator::kEqual:
    case Operator::kNotEqual:
      return compare(e, std::move(*left), std::move(*right));
    case Operator::kMultiply:
    case Operator::kDivide:
    case Operator::kRemainder:
    case Operator::kAdd:
    case Operator::kSubtract:
      return arithmetic(e, std::move(*left), std::move(*right));
    case Operator::kNot:  // of one operand
    case Operator::kNegate:
    case Operator::kPlus:
      break;
  }
  return std::nullopt;
}

// Reported, if neither name is declared.
bool Typer::is_call_without_parentheses(const Expression& e) {
  if (!may_be_call(e)) return false;
  const std::string& function = e.children[0].name.text;
  const std::string& topic = e.children[1].name.text;
  if (!symbols_.is_looked_up(function) || !symbols_.is_looked_up(topic)) {
    bare_.warn_of_bare_function(e.children[0]);
    return false;
  }
  const std::string meant = function + "(/" + topic + ")";
  fail(Code::kSyntax, e.span, "the argument of a function stands in parentheses", "write " + meant,
       Edit{e.span, meant});
  return true;
}

std::optional<Typed> Typer::logic(const Expression& e, Op op, Typed&& left, Typed&& right) {
  if (left.type == Type::kBool && right.type == Type::kBool) {
    return typed_node(op, Type::kBool, std::move(left), std::move(right));
  }
  const bool left_wrong = left.type != Type::kBool;
  return fail(Code::kTypeMismatch, e.children[left_wrong ? 0 : 1].span,
              std::string(symbol(e.op)) + " needs true or false on both sides; this is " +
                  describe(left_wrong ? left.type : right.type),
              "compare it with something, as in x > 0");
}

std::optional<Typed> Typer::compare(const Expression& e, Typed&& left, Typed&& right) {
  const Type a = left.type;
  const Type b = right.type;
  if (!make_alike(left, right)) return mismatch(e, a, b, "compare");
  if (a == Type::kString) bare_.warn_of_bare_text(e);
  const bool has_whole = a == Type::kInt || b == Type::kInt;
  if (has_whole && !bare_.check_bare_level(e)) return std::nullopt;
  bare_.warn_of_bare_value(e);
  const Op op = member(family(e.op), left.type);
  if (op == kNone) {
    return fail(Code::kTypeMismatch, e.span, "true and false have no order",
                "compare them with == or !=");
  }
  // > and >= are < and <= with the sides swapped.
  const bool swapped = e.op == Operator::kGreater || e.op == Operator::kGreaterEqual;
  if (swapped) std::swap(left, right);
  Typed comparison = typed_node(op, Type::kBool, std::move(left), std::move(right));
  if (e.op != Operator::kNotEqual) return comparison;
  return typed_node(Op::kNot, Type::kBool, std::move(comparison));
}

std::optional<Typed> Typer::arithmetic(const Expression& e, Typed left, Typed right) {
  if (left.type == Type::kDuration || right.type == Type::kDuration) {
    return duration_arithmetic(e, std::move(left), std::move(right));
  }
  if (!is_numeric(left.type) || !is_numeric(right.type))
    return mismatch(e, left.type, right.type, "calculate with");
  make_alike(left, right);
  const bool exact = left.type == Type::kInt;
  const Type result = left.type;
  return typed_node(arithmetic_op(e.op, exact), result, std::move(left), std::move(right));
}

std::optional<Typed> Typer::duration_arithmetic(const Expression& e, Typed left, Typed right) {
  const bool both = left.type == right.type;
  if (both && e.op == Operator::kDivide)
    return typed_node(Op::kRatio, Type::kDouble, std::move(left), std::move(right));
  if (both && e.op != Operator::kMultiply) {
    return typed_node(arithmetic_op(e.op, true), Type::kDuration, std::move(left),
                      std::move(right));
  }
  if (e.op == Operator::kMultiply && right.type == Type::kDuration) std::swap(left, right);
  const bool scales = e.op == Operator::kMultiply || e.op == Operator::kDivide;
  if (scales && left.type == Type::kDuration && is_numeric(right.type)) {
    auto factor = converted(std::move(right), Type::kDouble);
    const Op op = e.op == Operator::kMultiply ? Op::kScale : Op::kShrink;
    return typed_node(op, Type::kDuration, std::move(left), std::move(*factor));
  }
  return mismatch(e, left.type, right.type, "calculate with");
}

std::nullopt_t Typer::mismatch(const Expression& e, Type left, Type right,
                               const std::string& verb) {
  diagnostics_.push_back(type_mismatch(e, left, right, verb, symbols_));
  return std::nullopt;
}

std::nullopt_t Typer::fail(Code code, Span span, std::string cause, std::string remedy,
                           std::optional<Edit> fix) {
  diagnostics_.push_back(
      {code, Severity::kError, span, std::move(cause), std::move(remedy), std::move(fix)});
  return std::nullopt;
}

bool Typer::names_broken_constant(const Expression& e) const {
  if (e.kind == Kind::kName) {
    const auto* constant = symbols_.constant(e.name.text);
    return constant != nullptr && constant->broken;
  }
  return std::any_of(e.children.begin(), e.children.end(),
                     [&](const Expression& child) { return names_broken_constant(child); });
}

}  // namespace culprit
