#include "language/evaluate.h"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "language/checker.h"
#include "language/compiler.h"
#include "language/typing.h"

namespace culprit {
namespace {

// ---- The slow evaluator: recursive, one case after the other, as docs/rule-language.md says it.

using Result = std::optional<Value>;  // durations as their nanoseconds

Result number(double d) { return std::isfinite(d) ? Result(d) : std::nullopt; }

// Wide enough for every result of 64-bit operands.
__extension__ using Wide = __int128;

Result whole(Wide i) {
  const bool fits = i >= std::numeric_limits<std::int64_t>::min() &&
                    i <= std::numeric_limits<std::int64_t>::max();
  return fits ? Result(static_cast<std::int64_t>(i)) : std::nullopt;
}

Result from_slot(const Slot& slot, Type type) {
  if (!slot.known) return std::nullopt;
  return type == Type::kDuration ? Result(slot.i) : Result(to_value(slot, type));
}

Result slow(const Typed& e, std::span<const Slot> inputs);

Result slow_logic(const Typed& e, std::span<const Slot> inputs, bool dominant) {
  const Result a = slow(e.children[0], inputs);
  const Result b = slow(e.children[1], inputs);
  if (a == Result(dominant) || b == Result(dominant)) return dominant;
  return a && b ? Result(!dominant) : std::nullopt;
}

Result slow(const Typed& e, std::span<const Slot> inputs) {
  if (e.op == Op::kConstant) return from_slot(e.constant->view(), e.type);
  if (e.op == Op::kInput) return from_slot(inputs[e.input.index], e.type);
  if (e.op == Op::kAnd) return slow_logic(e, inputs, false);
  if (e.op == Op::kOr) return slow_logic(e, inputs, true);
  if (e.op == Op::kSelect) {
    const Result condition = slow(e.children[0], inputs);
    if (!condition) return std::nullopt;
    return slow(e.children[std::get<bool>(*condition) ? 1 : 2], inputs);
  }
  const Result first = slow(e.children[0], inputs);
  const Result second = e.children.size() > 1 ? slow(e.children[1], inputs) : Result(false);
  if (!first || !second) return std::nullopt;
  const auto b = [&] { return std::get<bool>(*first); };
  const auto i = [](const Result& r) { return std::get<std::int64_t>(*r); };
  const auto d = [](const Result& r) { return std::get<double>(*r); };
  const auto wide = [&](const Result& r) { return static_cast<Wide>(i(r)); };
  const auto real = [&](const Result& r) { return static_cast<double>(i(r)); };
  const auto rounded = [](double x) -> Result {
    if (!(std::fabs(x) < 9.3e18)) return std::nullopt;
    return whole(static_cast<Wide>(std::nearbyint(x)));
  };
  switch (e.op) {
    case Op::kIntToDouble:
      return real(first);
    case Op::kNot:
      return !b();
    case Op::kNegateInt:
      return whole(-wide(first));
    case Op::kNegateDouble:
      return -d(first);
    case Op::kAddInt:
      return whole(wide(first) + wide(second));
    case Op::kAddDouble:
      return number(d(first) + d(second));
    case Op::kSubtractInt:
      return whole(wide(first) - wide(second));
    case Op::kSubtractDouble:
      return number(d(first) - d(second));
    case Op::kMultiplyInt:
      return whole(wide(first) * wide(second));
    case Op::kMultiplyDouble:
      return number(d(first) * d(second));
    case Op::kDivideInt:
      return i(second) == 0 ? std::nullopt : whole(wide(first) / wide(second));
    case Op::kDivideDouble:
      return d(second) == 0 ? std::nullopt : number(d(first) / d(second));
    case Op::kRemainderInt:
      // The quotient of the lowest number and -1 does not fit, so the remainder that goes with it
      // is none.
      if (i(second) == 0 || !whole(wide(first) / wide(second))) return std::nullopt;
      return whole(wide(first) % wide(second));
    case Op::kRemainderDouble:
      return number(std::fmod(d(first), d(second)));
    case Op::kScale:
      return rounded(real(first) * d(second));
    case Op::kShrink:
      return rounded(real(first) / d(second));
    case Op::kRatio:
      return number(real(first) / real(second));
    case Op::kPower:
      return number(std::pow(d(first), d(second)));
    case Op::kSquareRoot:
      return d(first) < 0 ? std::nullopt : number(std::sqrt(d(first)));
    case Op::kAbsInt:
      return whole(i(first) < 0 ? -wide(first) : wide(first));
    case Op::kAbsDouble:
      return std::fabs(d(first));
    case Op::kMinInt:
      return std::min(i(first), i(second));
    case Op::kMinDouble:
      return std::min(d(second), d(first));
    case Op::kMaxInt:
      return std::max(i(first), i(second));
    case Op::kMaxDouble:
      return std::max(d(first), d(second));
    case Op::kLessInt:
    case Op::kLessDouble:
    case Op::kLessString:
      return *first < *second;
    case Op::kLessEqualInt:
    case Op::kLessEqualDouble:
    case Op::kLessEqualString:
      return *first <= *second;
    case Op::kEqualBool:
    case Op::kEqualInt:
    case Op::kEqualDouble:
    case Op::kEqualString:
      return *first == *second;
    default:
      ADD_FAILURE() << "no such operation";
      return std::nullopt;
  }
}

// ---- Random typed expressions and random stores.

struct Signature {
  Op op;
  Type result;
  std::vector<Type> operands;
};

const std::vector<Signature>& signatures() {
  using enum Type;
  static const std::vector<Signature> all = {
      {Op::kIntToDouble, kDouble, {kInt}},
      {Op::kNot, kBool, {kBool}},
      {Op::kAnd, kBool, {kBool, kBool}},
      {Op::kOr, kBool, {kBool, kBool}},
      {Op::kSelect, kBool, {kBool, kBool, kBool}},
      {Op::kSelect, kInt, {kBool, kInt, kInt}},
      {Op::kSelect, kDouble, {kBool, kDouble, kDouble}},
      {Op::kSelect, kString, {kBool, kString, kString}},
      {Op::kNegateInt, kInt, {kInt}},
      {Op::kNegateInt, kDuration, {kDuration}},
      {Op::kNegateDouble, kDouble, {kDouble}},
      {Op::kAddInt, kInt, {kInt, kInt}},
      {Op::kAddInt, kDuration, {kDuration, kDuration}},
      {Op::kAddDouble, kDouble, {kDouble, kDouble}},
      {Op::kSubtractInt, kInt, {kInt, kInt}},
      {Op::kSubtractDouble, kDouble, {kDouble, kDouble}},
      {Op::kMultiplyInt, kInt, {kInt, kInt}},
      {Op::kMultiplyDouble, kDouble, {kDouble, kDouble}},
      {Op::kDivideInt, kInt, {kInt, kInt}},
      {Op::kDivideDouble, kDouble, {kDouble, kDouble}},
      {Op::kRemainderInt, kInt, {kInt, kInt}},
      {Op::kRemainderDouble, kDouble, {kDouble, kDouble}},
      {Op::kScale, kDuration, {kDuration, kDouble}},
      {Op::kShrink, kDuration, {kDuration, kDouble}},
      {Op::kRatio, kDouble, {kDuration, kDuration}},
      {Op::kLessInt, kBool, {kInt, kInt}},
      {Op::kLessInt, kBool, {kDuration, kDuration}},
      {Op::kLessDouble, kBool, {kDouble, kDouble}},
      {Op::kLessString, kBool, {kString, kString}},
      {Op::kLessEqualInt, kBool, {kInt, kInt}},
      {Op::kLessEqualDouble, kBool, {kDouble, kDouble}},
      {Op::kLessEqualString, kBool, {kString, kString}},
      {Op::kEqualBool, kBool, {kBool, kBool}},
      {Op::kEqualInt, kBool, {kInt, kInt}},
      {Op::kEqualDouble, kBool, {kDouble, kDouble}},
      {Op::kEqualString, kBool, {kString, kString}},
      {Op::kAbsInt, kInt, {kInt}},
      {Op::kAbsDouble, kDouble, {kDouble}},
      {Op::kMinInt, kInt, {kInt, kInt}},
      {Op::kMinDouble, kDouble, {kDouble, kDouble}},
      {Op::kMaxInt, kInt, {kInt, kInt}},
      {Op::kMaxDouble, kDouble, {kDouble, kDouble}},
      {Op::kPower, kDouble, {kDouble, kDouble}},
      {Op::kSquareRoot, kDouble, {kDouble}},
  };
  return all;
}

constexpr std::size_t kInputsPerType = 3;
constexpr const char* kTexts[] = {"", "active", "inactive", "z"};

using Random = std::mt19937_64;

std::size_t below(std::size_t n, Random& random) {
  return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
}

template <class T, std::size_t n>
const T& pick(const T (&from)[n], Random& random) {
  return from[below(n, random)];
}

// Where results stop to exist, and a few between.
constexpr std::int64_t kWholes[] = {0, 1, -1, 2, 7, INT64_MAX, INT64_MIN, 1000000007};
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNumbers[] = {0.0,
                               -0.0,
                               1.0,
                               -1.5,
                               0.06,
                               1e308,
                               -1e308,
                               5e-324,
                               2.0,
                               9.3e18,
                               kInfinity,
                               -kInfinity,
                               std::numeric_limits<double>::quiet_NaN()};

Slot random_slot(Type type, Random& random) {
  if (below(4, random) == 0) return {};
  switch (type) {
    case Type::kBool:
      return Slot::of(below(2, random) == 0);
    case Type::kInt:
    case Type::kDuration:
      return Slot::of(pick(kWholes, random));
    case Type::kDouble:
      return Slot::of(pick(kNumbers, random));
    case Type::kString:
      return Slot::of(std::string_view(pick(kTexts, random)));
  }
  return {};
}

Typed random_leaf(Type type, Random& random) {
  Typed leaf;
  leaf.type = type;
  if (below(2, random) == 0) {
    leaf.op = Op::kInput;
    leaf.input =
        InputId(static_cast<std::size_t>(type) * kInputsPerType + below(kInputsPerType, random));
  } else {
    const Slot slot = random_slot(type, random);
    leaf.constant = Constant{slot, std::string(slot.s)};
  }
  return leaf;
}

Typed random_expression(Type type, std::size_t depth, Random& random) {
  std::vector<const Signature*> fitting;
  for (const Signature& s : signatures()) {
    if (s.result == type) fitting.push_back(&s);
  }
  if (depth == 0 || fitting.empty() || below(5, random) == 0) return random_leaf(type, random);
  const Signature& chosen = *fitting[below(fitting.size(), random)];
  Typed e;
  e.op = chosen.op;
  e.type = type;
  for (const Type operand : chosen.operands)
    e.children.push_back(random_expression(operand, depth - 1, random));
  return e;
}

bool same(const Result& a, const Result& b) {
  if (a.has_value() != b.has_value()) return false;
  return !a || *a == *b;
}

// CULPRIT_EXPRESSIONS says how many expressions are tried, each with several stores. Expression n
// is the same in every run.
TEST(Evaluate, AgreesWithAPlainTreeEvaluator) {
  constexpr Type kTypes[] = {Type::kBool, Type::kInt, Type::kDouble, Type::kString,
                             Type::kDuration};
  constexpr int kStores = 10;
  const char* wanted = std::getenv("CULPRIT_EXPRESSIONS");
  const std::uint64_t expressions = wanted == nullptr ? 20000 : std::strtoull(wanted, nullptr, 10);
  std::uint64_t known = 0;
  for (std::uint64_t n = 0; n < expressions; ++n) {
    Random random(n);
    const Type type = pick(kTypes, random);
    const Typed e = random_expression(type, 1 + below(6, random), random);
    const Program program = compile(e);
    for (int store = 0; store < kStores; ++store) {
      std::vector<Slot> inputs;
      for (const Type t : kTypes) {
        for (std::size_t i = 0; i < kInputsPerType; ++i) inputs.push_back(random_slot(t, random));
      }
      const Result fast = from_slot(evaluate(program, inputs), type);
      ASSERT_TRUE(same(fast, slow(e, inputs))) << "expression " << n << ", store " << store;
      known += fast.has_value() ? 1 : 0;
    }
  }
  // Both that there is a result and that there is none were tried often.
  const double share = static_cast<double>(known) / static_cast<double>(expressions * kStores);
  EXPECT_GT(share, 0.2);
  EXPECT_LT(share, 0.8);
}

// ---- What users write.

Slot constant(const std::string& expression) {
  const Source source("test", "RULE R\nPOLICIES ERROR\nTRIGGER (" + expression +
                                  ") && x > 0\nSTRATEGY s 50 10\nADAPTATION c restart 1\n");
  const Checked checked = check(source);
  EXPECT_TRUE(checked.rules) << (checked.diagnostics.empty()
                                     ? ""
                                     : render(checked.diagnostics[0], source));
  if (!checked.rules) return {};
  const Slot positive = Slot::of(1.0);
  return evaluate(checked.rules->rules[0].trigger, std::span(&positive, 1));
}

TEST(Evaluate, FollowsThePrecedenceOfCpp) {
  EXPECT_TRUE(constant("1 + 2 * 3 == 7").b);
  EXPECT_TRUE(constant("(1 + 2) * 3 == 9").b);
  EXPECT_TRUE(constant("10 - 4 - 3 == 3").b);
  EXPECT_TRUE(constant("7 / 2 == 3 && 7 / 2.0 == 3.5").b);
  EXPECT_TRUE(constant("-7 / 2 == -3 && -7 % 2 == -1").b);
  EXPECT_TRUE(constant("+7 - +2 == 5 && -+2 == +-2 && 1 + +1.5 == 2.5").b);
  EXPECT_TRUE(constant("!false && !!true").b);
  EXPECT_TRUE(constant("false && false || true").b);
  EXPECT_TRUE(constant("1 < 2 == true").b);
  EXPECT_TRUE(constant("false ? false : true ? true : false").b);
  EXPECT_TRUE(
      constant(
          "pow(2, -1) == 0.5 && sqrt(9) == 3 && abs(-2) == 2 && min(1, 2.5) == 1 && max(1, 2) == 2")
          .b);
}

TEST(Evaluate, CountsWithDurations) {
  EXPECT_TRUE(constant("500ms + 0.5s == 1s").b);
  EXPECT_TRUE(constant("+500ms == 0.5s").b);
  EXPECT_TRUE(constant("2 * 500ms == 1s && 1s * 0.5 == 500ms").b);
  EXPECT_TRUE(constant("3s / 2s == 1.5 && 3s / 2 == 1500ms").b);
  EXPECT_TRUE(constant("5s % 2s == 1s && -1s < 0s").b);
  EXPECT_TRUE(constant("max(1s, 200ms) == 1s").b);
}

TEST(Evaluate, GivesUnknownWhereThereIsNoResult) {
  for (const char* expression :
       {"1 / 0 == 0", "1 % 0 == 0", "1.0 / 0 > 5", "sqrt(-1) < 1", "9223372036854775807 + 1 > 0",
        "pow(10, 400) > 1", "1s / 0 > 1s", "1e308 * 10 > 1"}) {
    EXPECT_FALSE(constant(expression).known) << expression;
  }
}

TEST(Evaluate, LetsTheKnownSideDecideWhereItCan) {
  EXPECT_TRUE(constant("1 / 0 == 0 || true").b);
  const Slot no = constant("1 / 0 == 0 && false");
  EXPECT_TRUE(no.known && !no.b);
}

}  // namespace
}  // namespace culprit
