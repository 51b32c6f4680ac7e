#include "language/typing.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "base/units.h"
#include "language/compiler.h"
#include "language/evaluate.h"
#include "language/functions.h"
#include "language/line_reader.h"

namespace culprit {
namespace {

using syntax::Expression;
using syntax::Operator;
using Kind = Expression::Kind;

bool is_numeric(Type type) { return type == Type::kInt || type == Type::kDouble; }
bool is_exact(Type type) { return type == Type::kInt || type == Type::kDuration; }

template <class... Children>
Typed node(Op op, Type type, Children&&... children) {
  Typed typed;
  typed.op = op;
  typed.type = type;
  // Moved one by one: a list in braces would copy whole trees.
  typed.children.reserve(sizeof...(children));
  (typed.children.push_back(std::move(children)), ...);
  return typed;
}

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

class Typer {
 public:
  Typer(const Expression& whole, Symbols& symbols, std::vector<Diagnostic>& diagnostics)
      : whole_(whole), symbols_(symbols), diagnostics_(diagnostics) {}

  std::optional<Typed> type(const Expression& e) {
    auto typed = type_of(e);
    if (!typed) return typed;
    typed->span = e.span;
    // a != b is !(a == b) in one place.
    if (typed->op == Op::kNot && typed->children[0].span == Span{})
      typed->children[0].span = e.span;
    return typed;
  }

 private:
  std::optional<Typed> type_of(const Expression& e) {
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
        return call(e);
    }
    return std::nullopt;
  }

  std::optional<Typed> name(const Expression& e) {
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
    warn_of_bare_function(e);
    const auto type = symbols_.type_of(signal);
    if (!type) return unknown_type(e);
    Input wanted;
    wanted.kind = Input::Kind::kSignal;
    wanted.signal = signal;
    return input(wanted, *type);
  }

  // `memory > 500` waits for a signal of that name.
  void warn_of_bare_function(const Expression& e) {
    const FunctionInfo* function = find_function(e.name.text);
    if (is_part_of_call_ || function == nullptr || !symbols_.is_looked_up(e.name.text)) return;
    diagnostics_.push_back(
        {Code::kUnknownName, Severity::kWarning, e.span,
         "without parentheses, '" + e.name.text + "' is a signal, which is looked up on the robot",
         "usage of the function: " + std::string(function->usage)});
  }

  std::nullopt_t unknown_type(const Expression& e) {
    const std::string near = symbols_.forget_near_miss(e.name.text);
    if (!near.empty()) {
      return fail(Code::kUnknownName, e.span, "signal '" + e.name.text + "' is not declared",
                  "did you mean '" + near + "'?", Edit{e.span, near});
    }
    if (names_broken_constant(whole_)) return std::nullopt;  // which would have told
    return fail(Code::kUnknownType, e.span, "cannot infer the type of this value",
                "compare it with a constant; a text needs quotes: \"" + e.name.text + "\"");
  }

  Typed input(Input wanted, Type type) {
    wanted.type = type;
    Typed typed;
    typed.op = Op::kInput;
    typed.type = type;
    typed.input = symbols_.input(wanted);
    return typed;
  }

  std::optional<Typed> unary(const Expression& e) {
    auto operand = type(e.children[0]);
    if (!operand) return std::nullopt;
    const Type t = operand->type;
    if (e.op == Operator::kNot) {
      if (t == Type::kBool) return node(Op::kNot, t, std::move(*operand));
      return fail(Code::kTypeMismatch, e.children[0].span,
                  std::string("! needs true or false; this is ") + describe(t), "");
    }
    if (e.op == Operator::kPlus && (is_exact(t) || t == Type::kDouble)) return operand;
    if (is_exact(t)) return node(Op::kNegateInt, t, std::move(*operand));
    if (t == Type::kDouble) return node(Op::kNegateDouble, t, std::move(*operand));
    return fail(Code::kTypeMismatch, e.children[0].span,
                std::string(symbol(e.op)) + " needs a number; this is " + describe(t), "");
  }

  std::optional<Typed> conditional(const Expression& e) {
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
    if (!no || !alike(*yes, *no)) {
      if (no) mismatch(e, yes->type, no->type, "choose between");
      return std::nullopt;
    }
    const Type result = yes->type;
    return node(Op::kSelect, result, std::move(*condition), std::move(*yes), std::move(*no));
  }

  std::optional<Typed> binary(const Expression& e) {
    if (is_comparison(e) && compares_with_nothing(e)) return std::nullopt;
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
        return compare(e, kLess, std::move(*left), std::move(*right));
      case Operator::kLessEqual:
        return compare(e, kLessEqual, std::move(*left), std::move(*right));
      case Operator::kGreater:
        return compare(e, kLess, std::move(*right), std::move(*left));
      case Operator::kGreaterEqual:
        return compare(e, kLessEqual, std::move(*right), std::move(*left));
      case Operator::kEqual:
        return compare(e, kEqual, std::move(*left), std::move(*right));
      case Operator::kNotEqual: {
        auto equal = compare(e, kEqual, std::move(*left), std::move(*right));
        if (!equal) return std::nullopt;
        return node(Op::kNot, Type::kBool, std::move(*equal));
      }
      default:
        return arithmetic(e, std::move(*left), std::move(*right));
    }
  }

  // "age /scan" is a division for the parser.
  static bool may_be_call(const Expression& e) {
    return e.op == Operator::kDivide && e.children[0].kind == Kind::kName &&
           e.children[1].kind == Kind::kName && find_function(e.children[0].name.text) != nullptr;
  }

  // Reported, if neither name is declared.
  bool is_call_without_parentheses(const Expression& e) {
    if (!may_be_call(e)) return false;
    const std::string& function = e.children[0].name.text;
    const std::string& topic = e.children[1].name.text;
    if (!symbols_.is_looked_up(function) || !symbols_.is_looked_up(topic)) {
      warn_of_bare_function(e.children[0]);
      return false;
    }
    const std::string meant = function + "(/" + topic + ")";
    fail(Code::kSyntax, e.span, "the argument of a function stands in parentheses",
         "write " + meant, Edit{e.span, meant});
    return true;
  }

  std::optional<Typed> logic(const Expression& e, Op op, Typed&& left, Typed&& right) {
    if (left.type == Type::kBool && right.type == Type::kBool) {
      return node(op, Type::kBool, std::move(left), std::move(right));
    }
    const bool left_wrong = left.type != Type::kBool;
    return fail(Code::kTypeMismatch, e.children[left_wrong ? 0 : 1].span,
                std::string(symbol(e.op)) + " needs true or false on both sides; this is " +
                    describe(left_wrong ? left.type : right.type),
                "compare it with something, as in x > 0");
  }

  std::optional<Typed> compare(const Expression& e, const Family& family, Typed&& left,
                               Typed&& right) {
    const Type a = left.type;
    const Type b = right.type;
    if (!alike(left, right))
      return mismatch(e, type_at(e, 0, a, b), type_at(e, 1, a, b), "compare");
    if (a == Type::kString) warn_of_bare_text(e);
    const bool has_whole = a == Type::kInt || b == Type::kInt;
    if (has_whole && !check_bare_level(e)) return std::nullopt;
    warn_of_bare_value(e);
    const Op op = member(family, left.type);
    if (op == kNone) {
      return fail(Code::kTypeMismatch, e.span, "true and false have no order",
                  "compare them with == or !=");
    }
    return node(op, Type::kBool, std::move(left), std::move(right));
  }

  // "battery == nan", "battery == None": reported.
  bool compares_with_nothing(const Expression& e) {
    constexpr std::array<std::string_view, 5> kNothing = {"NAN", "NONE", "NULL", "NIL",
                                                          "UNDEFINED"};
    const Expression& side = e.children[1];
    const bool is_so = side.kind == Kind::kName && symbols_.is_looked_up(side.name.text) &&
                       std::ranges::find(kNothing, upper_case(side.name.text)) != kNothing.end();
    if (!is_so) return false;
    symbols_.forget_near_miss(side.name.text);
    fail(Code::kUnknownName, side.span, "'" + side.name.text + "' is no value of the language",
         remedy_of_bare_value(e.children[0], side.name.text));
    return true;
  }

  // `lifecycle(camera) == active` would wait for a signal of that name.
  void warn_of_bare_text(const Expression& e) {
    constexpr std::array<std::string_view, 4> kStates = {"unconfigured", "inactive", "active",
                                                         "finalized"};
    for (const Expression& side : e.children) {
      if (side.kind != Kind::kName || !symbols_.is_looked_up(side.name.text)) continue;
      std::string name = side.name.text;
      std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
      if (std::find(kStates.begin(), kStates.end(), name) == kStates.end()) continue;
      diagnostics_.push_back(
          {Code::kUnknownName, Severity::kWarning, side.span,
           "without quotes, '" + side.name.text + "' is a signal, which is looked up on the robot",
           "a state stands in quotes: write \"" + name + "\"",
           Edit{side.span, "\"" + name + "\""}});
    }
  }

  // `entropy > high` would wait for a signal of that name. Two names may be two signals of the robot.
  void warn_of_bare_value(const Expression& e) {
    const Expression& left = e.children[0];
    const Expression& right = e.children[1];
    const auto is_unknown_name = [&](const Expression& side) {
      return side.kind == Kind::kName && symbols_.is_looked_up(side.name.text);
    };
    const bool is_value = left.kind == Kind::kLiteral;
    if (is_value || !is_unknown_name(right) || is_unknown_name(left)) return;
    const bool is_reported = std::ranges::any_of(
        diagnostics_, [&](const Diagnostic& d) { return d.span == right.span; });
    if (is_reported) return;
    const std::string& name = right.name.text;
    diagnostics_.push_back(
        {Code::kUnknownName, Severity::kWarning, right.span,
         "'" + name + "' is not declared: it is a signal, which is looked up on the robot",
         remedy_of_bare_value(left, name)});
  }

  static std::string remedy_of_bare_value(const Expression& left, const std::string& name) {
    const std::string word = upper_case(name);
    const auto is_one_of = [&](std::initializer_list<std::string_view> words) {
      return std::ranges::find(words, word) != words.end();
    };
    if (is_one_of({"NAN"}))
      return "write isnan(" + (left.kind == Kind::kName ? left.name.text : "signal") + ")";
    if (is_one_of({"NULL", "NONE", "NIL", "UNKNOWN", "UNDEFINED"}))
      return "no value can be compared with a missing one: age(/topic) > 1s tells that none comes";
    if (is_one_of({"YES", "ON"})) return "write true";
    if (is_one_of({"NO", "OFF"})) return "write false";
    return "write a value, or declare it: CONST " + name + " = 0.5, or SIGNAL " + name + " ...";
  }

  static bool is_call_of(const Expression& e, std::string_view function) {
    return e.kind == Kind::kCall && e.name.text == function;
  }

  // The number of a diagnostic's level; null: the word is none.
  static std::optional<std::string> level_number(std::string_view word) {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kLevels = {
        {{"OK", "0"}, {"WARN", "1"}, {"WARNING", "1"}, {"ERROR", "2"}, {"STALE", "3"}}};
    const std::string upper = upper_case(word);
    for (const auto& [level, number] : kLevels) {
      if (level == upper) return std::string(number);
    }
    return std::nullopt;
  }

  static std::string level_remedy(const std::string& number) {
    return "a level is a number (0 OK, 1 WARN, 2 ERROR, 3 STALE): write " + number;
  }

  // `level(motors) == ERROR` would wait for a signal of that name. False: it was reported.
  bool check_bare_level(const Expression& e) {
    for (std::size_t i = 0; i < 2; ++i) {
      const Expression& side = e.children[i];
      if (!is_call_of(e.children[1 - i], "level") || side.kind != Kind::kName ||
          !symbols_.is_looked_up(side.name.text))
        continue;
      const auto number = level_number(side.name.text);
      if (!number) continue;
      fail(Code::kUnknownName, side.span, "signal '" + side.name.text + "' is not declared",
           level_remedy(*number), Edit{side.span, *number});
      return false;
    }
    return true;
  }

  static bool is_comparison(const Expression& e) {
    return e.kind == Kind::kBinary && e.op >= Operator::kLess && e.op <= Operator::kNotEqual;
  }

  // > and >= are < and <= with the sides swapped; messages speak of the sides as written.
  static Type type_at(const Expression& e, int side, Type first, Type second) {
    const bool swapped = e.op == Operator::kGreater || e.op == Operator::kGreaterEqual;
    return (side == 0) != swapped ? first : second;
  }

  std::optional<Typed> arithmetic(const Expression& e, Typed left, Typed right) {
    if (left.type == Type::kDuration || right.type == Type::kDuration) {
      return duration_arithmetic(e, std::move(left), std::move(right));
    }
    if (!is_numeric(left.type) || !is_numeric(right.type))
      return mismatch(e, left.type, right.type, "calculate with");
    alike(left, right);
    const bool exact = left.type == Type::kInt;
    const Type result = left.type;
    return node(arithmetic_op(e.op, exact), result, std::move(left), std::move(right));
  }

  static Op arithmetic_op(Operator op, bool exact) {
    switch (op) {
      case Operator::kAdd:
        return exact ? Op::kAddInt : Op::kAddDouble;
      case Operator::kSubtract:
        return exact ? Op::kSubtractInt : Op::kSubtractDouble;
      case Operator::kMultiply:
        return exact ? Op::kMultiplyInt : Op::kMultiplyDouble;
      case Operator::kDivide:
        return exact ? Op::kDivideInt : Op::kDivideDouble;
      default:
        return exact ? Op::kRemainderInt : Op::kRemainderDouble;
    }
  }

  std::optional<Typed> duration_arithmetic(const Expression& e, Typed left, Typed right) {
    const bool both = left.type == right.type;
    if (both && e.op == Operator::kDivide)
      return node(Op::kRatio, Type::kDouble, std::move(left), std::move(right));
    if (both && e.op != Operator::kMultiply) {
      return node(arithmetic_op(e.op, true), Type::kDuration, std::move(left), std::move(right));
    }
    if (e.op == Operator::kMultiply && right.type == Type::kDuration) std::swap(left, right);
    const bool scales = e.op == Operator::kMultiply || e.op == Operator::kDivide;
    if (scales && left.type == Type::kDuration && is_numeric(right.type)) {
      auto factor = converted(std::move(right), Type::kDouble);
      const Op op = e.op == Operator::kMultiply ? Op::kScale : Op::kShrink;
      return node(op, Type::kDuration, std::move(left), std::move(*factor));
    }
    return mismatch(e, left.type, right.type, "calculate with");
  }

  std::optional<Typed> call(const Expression& e) {
    const Function function = find_function(e.name.text)->function;
    Input wanted;
    switch (function) {
      case Function::kRate:
        return rate(e);
      case Function::kAge:
      case Function::kPhi:
      case Function::kLoss: {
        const auto topic = topic_argument(e.children[0]);
        if (!topic) return std::nullopt;
        wanted.kind = function == Function::kAge   ? Input::Kind::kAge
                      : function == Function::kPhi ? Input::Kind::kPhi
                                                   : Input::Kind::kLoss;
        wanted.topic = *topic;
        return input(wanted, function == Function::kAge ? Type::kDuration : Type::kDouble);
      }
      case Function::kAlive:
      case Function::kLifecycle:
        wanted.kind = function == Function::kAlive ? Input::Kind::kAlive : Input::Kind::kLifecycle;
        wanted.component = symbols_.component(e.children[0].name);
        return input(wanted, function == Function::kAlive ? Type::kBool : Type::kString);
      case Function::kParameter: {
        wanted.kind = Input::Kind::kParameter;
        if (is_swapped(e)) return std::nullopt;
        wanted.component = symbols_.component(e.children[0].name);
        wanted.parameter = symbols_.parameter(wanted.component, e.children[1].name.text);
        const auto type = symbols_.type_of(wanted.parameter);
        if (!type) return unknown_type(e.children[1]);
        return input(wanted, *type);
      }
      case Function::kLevel:
        wanted.kind = Input::Kind::kLevel;
        wanted.diagnostic = symbols_.diagnostic(e.children[0].name.text);
        return input(wanted, Type::kInt);
      case Function::kMean:
        return window(e, Input::Kind::kMean);
      case Function::kStddev:
        return window(e, Input::Kind::kStddev);
      case Function::kChanged: {
        const auto signal = signal_argument(e.children[0], "changed(signal)");
        if (!signal) return std::nullopt;
        wanted.kind = Input::Kind::kChanged;
        wanted.signal = *signal;
        return input(wanted, Type::kBool);
      }
      case Function::kFrozen: {
        const auto signal = signal_argument(e.children[0], "frozen(signal, window)");
        if (!signal) return std::nullopt;
        const auto length = window_argument(e.children[1]);
        if (!length) return std::nullopt;
        wanted.kind = Input::Kind::kFrozen;
        wanted.signal = *signal;
        wanted.window = *length;
        return input(wanted, Type::kBool);
      }
      case Function::kGoals:
        return goals(e);
      case Function::kGoalAge: {
        const auto topic = action_argument(e.children[0]);
        if (!topic) return std::nullopt;
        wanted.kind = Input::Kind::kGoalAge;
        wanted.topic = *topic;
        return input(wanted, Type::kDuration);
      }
      case Function::kLogs:
        return logs(e);
      case Function::kCpu:
      case Function::kMemory:
        wanted.kind = function == Function::kCpu ? Input::Kind::kCpu : Input::Kind::kMemory;
        wanted.component = symbols_.component(e.children[0].name);
        return input(wanted, Type::kDouble);
      case Function::kIsNan: {
        const auto signal = signal_argument(e.children[0], "isnan(signal)");
        if (!signal) return std::nullopt;
        if (const auto type = symbols_.type_of(*signal); !type || !is_numeric(*type))
          return fail(Code::kTypeMismatch, e.children[0].span, "isnan needs a number", "");
        wanted.kind = Input::Kind::kIsNan;
        wanted.signal = *signal;
        return input(wanted, Type::kBool);
      }
      case Function::kMin:
        return is_window(e) ? window(e, Input::Kind::kMin)
                            : extreme(e, Op::kMinInt, Op::kMinDouble);
      case Function::kMax:
        return is_window(e) ? window(e, Input::Kind::kMax)
                            : extreme(e, Op::kMaxInt, Op::kMaxDouble);
      case Function::kAbs:
        return absolute(e);
      case Function::kPow:
        return real_function(e, Op::kPower);
      case Function::kSqrt:
        return real_function(e, Op::kSquareRoot);
    }
    return std::nullopt;
  }

  // parameter(fps, camera): reported.
  bool is_swapped(const Expression& e) {
    const std::string& first = e.children[0].name.text;
    const std::string& second = e.children[1].name.text;
    if (symbols_.is_declared_component(first) || !symbols_.is_declared_component(second))
      return false;
    const Span both{e.children[0].span.begin, e.children[1].span.end};
    const std::string right = second + ", " + first;
    fail(Code::kArguments, both, "the component stands in front of its parameter",
         "write parameter(" + right + ")", Edit{both, right});
    return true;
  }

  std::optional<Typed> goals(const Expression& e) {
    const auto topic = action_argument(e.children[0]);
    if (!topic) return std::nullopt;
    const syntax::Name& word = e.children[1].name;
    const auto outcome = counted_outcome(word.text);
    if (!outcome) {
      const std::string near = closest(word.text, counted_outcomes());
      return fail(Code::kArguments, word.span, "no goal ends as '" + word.text + "'",
                  near.empty() ? "write aborted, canceled, succeeded or accepted"
                               : "did you mean '" + near + "'?",
                  replacement(word.span, near));
    }
    const auto length = window_argument(e.children[2]);
    if (!length) return std::nullopt;
    Input wanted;
    wanted.kind = Input::Kind::kGoals;
    wanted.topic = *topic;
    wanted.outcome = *outcome;
    wanted.window = *length;
    return input(wanted, Type::kInt);
  }

  std::optional<Typed> logs(const Expression& e) {
    const syntax::Name& word = e.children[1].name;
    const auto level = log_level(word.text);
    if (!level) {
      const std::string upper = upper_case(word.text);
      const std::string near = log_level(upper) ? upper : closest(upper, log_levels());
      return fail(
          Code::kArguments, word.span, "no log has the level '" + word.text + "'",
          near.empty() ? "write DEBUG, INFO, WARN, ERROR or FATAL" : "did you mean '" + near + "'?",
          replacement(word.span, near));
    }
    const auto length = window_argument(e.children[2]);
    if (!length) return std::nullopt;
    Input wanted;
    wanted.kind = Input::Kind::kLogs;
    wanted.component = symbols_.component(e.children[0].name);
    wanted.log_level = *level;
    wanted.window = *length;
    return input(wanted, Type::kInt);
  }

  std::optional<TopicId> action_argument(const Expression& e) {
    const std::string& name = e.name.text;
    if (name.starts_with('/') && is_component_reference(name))
      return symbols_.topic(name + std::string(kStatusOfAction));
    return fail(Code::kBadRosName, e.span, "'" + name + "' is no full name of an action",
                "write it with its namespace, as in /navigate_to_pose");
  }

  std::optional<Typed> rate(const Expression& e) {
    constexpr Duration kDefaultWindow = std::chrono::seconds(2);
    const auto topic = topic_argument(e.children[0]);
    if (!topic) return std::nullopt;
    Input wanted;
    wanted.kind = Input::Kind::kRate;
    wanted.topic = *topic;
    wanted.window = kDefaultWindow;
    if (e.children.size() == 2) {
      const auto given = window_argument(e.children[1]);
      if (!given) return std::nullopt;
      wanted.window = *given;
    }
    return input(wanted, Type::kDouble);
  }

  // min and max of a signal over a time, not of two values: a bare signal and a duration.
  bool is_window(const Expression& e) const {
    const Expression& first = e.children[0];
    return first.kind == Kind::kName && symbols_.constant(first.name.text) == nullptr &&
           e.children[1].kind == Kind::kLiteral &&
           std::holds_alternative<Duration>(*e.children[1].literal);
  }

  std::optional<Typed> window(const Expression& e, Input::Kind kind) {
    const auto signal =
        signal_argument(e.children[0], std::string(find_function(e.name.text)->usage));
    if (!signal) return std::nullopt;
    if (symbols_.type_of(*signal) != Type::kDouble) {
      return fail(Code::kTypeMismatch, e.children[0].span,
                  e.name.text + " over time needs a number", "");
    }
    const auto length = window_argument(e.children[1]);
    if (!length) return std::nullopt;
    Input wanted;
    wanted.kind = kind;
    wanted.signal = *signal;
    wanted.window = *length;
    return input(wanted, Type::kDouble);
  }

  std::optional<Duration> window_argument(const Expression& e) {
    auto typed = type(e);
    if (!typed) return std::nullopt;
    const bool constant = typed->type == Type::kDuration && !reads_inputs(*typed);
    const Slot slot = constant ? evaluate(compile(*typed), {}) : Slot();
    constexpr Duration kLongest = std::chrono::hours(24);
    if (!slot.known) {
      return fail(Code::kTypeMismatch, e.span, "a window is a constant duration",
                  "write for example 2s");
    }
    if (Duration(slot.i) <= Duration::zero())
      return fail(Code::kPolicyRange, e.span, "a window is longer than zero", "");
    if (Duration(slot.i) > kLongest) {
      return fail(Code::kLongWindow, e.span, "a window is at most a day long",
                  "write 24h or less; age(topic) > 36h notices silence that lasts longer");
    }
    return Duration(slot.i);
  }

  std::optional<SignalId> signal_argument(const Expression& e, const std::string& usage) {
    const bool is_signal = e.kind == Kind::kName && symbols_.constant(e.name.text) == nullptr;
    if (is_signal) return symbols_.signal(e.name);
    return fail(Code::kArguments, e.span, "this must be a signal", "usage: " + usage);
  }

  std::optional<TopicId> topic_argument(const Expression& e) {
    if (e.name.text.starts_with('/') && is_component_reference(e.name.text)) {
      std::optional<ComponentId> publisher;
      if (!e.children.empty()) {
        const syntax::Name& name = e.children[0].name;
        if (!is_component_reference(name.text))
          return fail(Code::kBadRosName, name.span, "'" + name.text + "' names no component",
                      "write the name of a component, or the full name of its node");
        publisher = symbols_.component(name);
      }
      return symbols_.topic(e.name.text, publisher);
    }
    if (const auto bracket = e.name.text.find('['); bracket != std::string::npos)
      return window_in_brackets(e, bracket);
    if (const auto topic = symbols_.topic_of_signal(e.name.text); !topic.empty())
      return fail(Code::kBadRosName, e.span, "'" + e.name.text + "' is a signal, and no topic",
                  "write its topic, " + topic, Edit{e.span, topic});
    return fail(Code::kBadRosName, e.span, "'" + e.name.text + "' is no full topic name",
                e.name.text.starts_with('/')
                    ? remedy_of_ros_name(e.name.text)
                    : "write it with its namespace, as in /robot/camera/image");
  }

  // "rate(/scan[5m])"
  std::nullopt_t window_in_brackets(const Expression& e, std::size_t bracket) {
    const std::string topic = e.name.text.substr(0, bracket);
    std::string window = e.name.text.substr(bracket + 1);
    if (window.ends_with(']')) window.pop_back();
    if (window.ends_with('m')) window += "in";
    const bool is_window = parse_duration(window).has_value();
    return fail(Code::kBadRosName, e.span, "no brackets stand behind a topic",
                is_window ? "write " + topic + ", " + window + ": only rate takes a window"
                          : "write " + topic);
  }

  std::optional<Typed> extreme(const Expression& e, Op exact, Op real) {
    auto a = type(e.children[0]);
    if (!a) return std::nullopt;
    auto b = type(e.children[1]);
    if (!b) return std::nullopt;
    const bool ordered = a->type != Type::kBool && a->type != Type::kString;
    if (!ordered || !alike(*a, *b)) return mismatch(e, a->type, b->type, "calculate with");
    const Type result = a->type;
    return node(is_exact(result) ? exact : real, result, std::move(*a), std::move(*b));
  }

  std::optional<Typed> absolute(const Expression& e) {
    auto a = type(e.children[0]);
    if (!a) return std::nullopt;
    const Type t = a->type;
    if (is_exact(t)) return node(Op::kAbsInt, t, std::move(*a));
    if (t == Type::kDouble) return node(Op::kAbsDouble, t, std::move(*a));
    return fail(Code::kTypeMismatch, e.children[0].span,
                std::string("abs needs a number; this is ") + describe(t), "");
  }

  std::optional<Typed> real_function(const Expression& e, Op op) {
    Typed result = node(op, Type::kDouble);
    for (const Expression& child : e.children) {
      auto typed = type(child);
      if (!typed) return std::nullopt;
      const Type t = typed->type;
      auto real = converted(std::move(*typed), Type::kDouble);
      if (!real) {
        return fail(Code::kTypeMismatch, child.span,
                    e.name.text + " needs a number; this is " + describe(t), "");
      }
      result.children.push_back(std::move(*real));
    }
    return result;
  }

  // Makes both of one type if a whole number may become a number.
  static bool alike(Typed& a, Typed& b) {
    if (a.type == b.type) return true;
    if (!is_numeric(a.type) || !is_numeric(b.type)) return false;
    Typed& whole = a.type == Type::kInt ? a : b;
    whole = *converted(std::move(whole), Type::kDouble);
    return true;
  }

  std::nullopt_t mismatch(const Expression& e, Type left, Type right, const std::string& verb) {
    std::string remedy;
    std::optional<Edit> fix;
    const bool duration_and_number = (left == Type::kDuration && is_numeric(right)) ||
                                     (right == Type::kDuration && is_numeric(left));
    if (duration_and_number) remedy = unit_remedy(e, left == Type::kDuration ? 1 : 0);
    if (verb == "compare" && (left == Type::kString || right == Type::kString))
      remedy = text_remedy(e, left == Type::kString ? 1 : 0);
    if (verb == "compare" && remedy.empty() && (left == Type::kBool || right == Type::kBool))
      remedy = truth_remedy(e, left == Type::kBool ? 0 : 1);
    if (verb == "compare" && is_comparison(e.children[0]))
      remedy = "to test a range, write a < x && x < b";
    for (std::size_t i = 0; i < 2 && verb == "compare"; ++i) {
      const Expression& text = e.children[i];
      const bool is_text =
          text.kind == Kind::kLiteral && std::holds_alternative<std::string>(*text.literal);
      if (!is_text || !is_call_of(e.children[1 - i], "level")) continue;
      const auto number = level_number(std::get<std::string>(*text.literal));
      if (!number) continue;
      remedy = level_remedy(*number);
      fix = Edit{text.span, *number};
    }
    return fail(Code::kTypeMismatch, e.span,
                "cannot " + verb + " " + describe(left) + " and " + describe(right),
                std::move(remedy), std::move(fix));
  }

  // `number`: which side of `e` is none of a duration.
  static std::string unit_remedy(const Expression& e, std::size_t number) {
    const Expression& side = e.children[number];
    if (side.kind == Kind::kCall && side.name.text == "rate")
      return "a rate is a number in Hz: write the number without a unit";
    constexpr std::array<std::string_view, 5> kNumbers = {"phi", "loss", "cpu", "memory", "goals"};
    if (side.kind == Kind::kCall && std::ranges::find(kNumbers, side.name.text) != kNumbers.end())
      return side.name.text + " is a number: write the other side without a unit";
    const auto* whole =
        side.kind == Kind::kLiteral ? std::get_if<std::int64_t>(&*side.literal) : nullptr;
    if (whole != nullptr)
      return "add a unit to the number: " + std::to_string(*whole) + "s or " +
             std::to_string(*whole) + "ms";
    return "give the number a unit, as in 500ms or 2s";
  }

  // `truth`: which side of `e` is true or false.
  static std::string truth_remedy(const Expression& e, std::size_t truth) {
    const bool is_literal = e.children[truth].kind == Kind::kLiteral;
    return is_literal ? "compare it with a number, as in x > 0.5"
                      : "write the condition by itself, or ! in front of it";
  }

  // `other`: which side of `e` is no text.
  std::string text_remedy(const Expression& e, std::size_t other) const {
    const Expression& side = e.children[other];
    const Expression& text = e.children[1 - other];
    const auto* written =
        text.kind == Kind::kLiteral ? std::get_if<std::string>(&*text.literal) : nullptr;
    const auto* constant = text.kind == Kind::kName ? symbols_.constant(text.name.text) : nullptr;
    if (constant != nullptr)
      return "'" + text.name.text + "' is a text: remove the quotes in its CONST line";
    if (written != nullptr && symbols_.constant(*written) != nullptr)
      return "'" + *written + "' is a constant: remove the quotes";
    if (written == nullptr)
      return "this side is a text: compare it with a text in quotes, as in \"active\"";
    if (*written == "true" || *written == "false") return "write " + *written + " without quotes";
    if (parse_duration(*written)) return "write " + *written + " without quotes";
    double number = 0;
    const char* end = written->data() + written->size();
    const auto read = std::from_chars(written->data(), end, number);
    if (read.ec == std::errc() && read.ptr == end) return "write " + *written + " without quotes";
    const std::string name =
        side.kind == Kind::kName ? "'" + side.name.text + "'" : "the other side";
    return "\"" + *written + "\" is a text, and " + name + " is not: compare values of one type";
  }

  std::nullopt_t fail(Code code, Span span, std::string cause, std::string remedy,
                      std::optional<Edit> fix = {}) {
    diagnostics_.push_back(
        {code, Severity::kError, span, std::move(cause), std::move(remedy), std::move(fix)});
    return std::nullopt;
  }

  bool names_broken_constant(const Expression& e) const {
    if (e.kind == Kind::kName) {
      const auto* constant = symbols_.constant(e.name.text);
      return constant != nullptr && constant->broken;
    }
    return std::any_of(e.children.begin(), e.children.end(),
                       [&](const Expression& child) { return names_broken_constant(child); });
  }

  const Expression& whole_;
  Symbols& symbols_;
  std::vector<Diagnostic>& diagnostics_;
  bool is_part_of_call_ = false;  // the name at hand, probably
};

}  // namespace

std::optional<Typed> type_expression(const Expression& expression, Symbols& symbols,
                                     std::vector<Diagnostic>& diagnostics) {
  return Typer(expression, symbols, diagnostics).type(expression);
}

std::optional<Typed> converted(Typed typed, Type wanted) {
  if (typed.type == wanted) return typed;
  if (typed.type == Type::kInt && wanted == Type::kDouble) {
    return node(Op::kIntToDouble, Type::kDouble, std::move(typed));
  }
  return std::nullopt;
}

const char* describe(Type type) {
  switch (type) {
    case Type::kBool:
      return "true or false";
    case Type::kInt:
      return "a whole number";
    case Type::kDouble:
      return "a number";
    case Type::kString:
      return "a text";
    case Type::kDuration:
      return "a duration";
  }
  return "";
}

}  // namespace culprit
