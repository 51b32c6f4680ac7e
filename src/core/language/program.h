// Expressions, compiled: a flat postfix program, the paper's reverse Polish notation.
//
// Types are settled at check time, so every instruction knows what it works on, and evaluation can
// neither fail nor allocate. Unknown values take the place of errors:
//   - logic is three-valued (Kleene): unknown && false is false, unknown || true is true, otherwise
//     unknown stays unknown;
//   - arithmetic and comparison with an unknown operand is unknown;
//   - a result that does not exist is unknown: division by zero, remainder by zero, an integer or
//     duration that overflows, a double that is not finite;
//   - a conditional with an unknown condition is unknown.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/ids.h"
#include "base/units.h"
#include "base/value.h"

namespace culprit {

enum class Type : std::uint8_t { kBool, kInt, kDouble, kString, kDuration };
std::string_view to_string(Type type);

// One typed value or "unknown". Durations are nanoseconds in `i`. Text is borrowed: it lives in the
// program's constants or in whatever provides the inputs.
struct Slot {
  union {
    bool b;
    std::int64_t i;
    double d;
  };
  std::string_view s;
  bool known = false;

  constexpr Slot() : i(0) {}
  static Slot of(bool value);
  static Slot of(std::int64_t value);
  static Slot of(double value);  // not finite: unknown only if NaN
  static Slot of(Duration value) { return of(static_cast<std::int64_t>(value.count())); }
  static Slot of(std::string_view value);
};

enum class Op : std::uint8_t {
  kConstant,     // push constants[operand]
  kInput,        // push inputs[operand]
  kIntToDouble,  // int -> the same number as a double

  kNot,     // bool -> bool
  kAnd,     // bool, bool -> bool: Kleene's, as all logic here
  kOr,      // bool, bool -> bool
  kSelect,  // condition, then, otherwise -> one of the two

  // The Int instructions also serve durations, in nanoseconds.
  kNegateInt,        // a -> -a; unknown if it overflows
  kNegateDouble,     // a -> -a
  kAddInt,           // a, b -> a + b; unknown if it overflows
  kAddDouble,        // a, b -> a + b
  kSubtractInt,      // a, b -> a - b; unknown if it overflows
  kSubtractDouble,   // a, b -> a - b
  kMultiplyInt,      // a, b -> a * b; unknown if it overflows
  kMultiplyDouble,   // a, b -> a * b
  kDivideInt,        // a, b -> a / b toward zero; unknown if b is 0 or it overflows
  kDivideDouble,     // a, b -> a / b; unknown if b is 0
  kRemainderInt,     // a, b -> a % b, with the sign of a; unknown as above
  kRemainderDouble,  // a, b -> fmod(a, b); unknown if b is 0
  kScale,            // duration, double -> their product, a duration
  kShrink,           // duration, double -> their quotient, a duration
  kRatio,            // duration, duration -> their quotient, a double

  kLessInt,          // a, b -> a < b
  kLessDouble,       // a, b -> a < b
  kLessString,       // a, b -> a < b, byte by byte
  kLessEqualInt,     // a, b -> a <= b
  kLessEqualDouble,  // a, b -> a <= b
  kLessEqualString,  // a, b -> a <= b, byte by byte
  kEqualBool,        // a, b -> a == b
  kEqualInt,         // a, b -> a == b
  kEqualDouble,      // a, b -> a == b
  kEqualString,      // a, b -> a == b

  kAbsInt,      // a -> |a|; unknown if it overflows
  kAbsDouble,   // a -> |a|
  kMinInt,      // a, b -> the smaller one
  kMinDouble,   // a, b -> the smaller one
  kMaxInt,      // a, b -> the larger one
  kMaxDouble,   // a, b -> the larger one
  kPower,       // a, b -> a to the power of b, doubles; unknown if it is not finite
  kSquareRoot,  // a -> its root, doubles; unknown if a is negative
};
// How many operands the instruction takes off the stack. Each leaves one result.
constexpr int operand_count(Op op) {
  switch (op) {
    case Op::kConstant:
    case Op::kInput:
      return 0;
    case Op::kIntToDouble:
    case Op::kNot:
    case Op::kNegateInt:
    case Op::kNegateDouble:
    case Op::kAbsInt:
    case Op::kAbsDouble:
    case Op::kSquareRoot:
      return 1;
    case Op::kSelect:
      return 3;
    case Op::kAnd:
    case Op::kOr:
    case Op::kAddInt:
    case Op::kAddDouble:
    case Op::kSubtractInt:
    case Op::kSubtractDouble:
    case Op::kMultiplyInt:
    case Op::kMultiplyDouble:
    case Op::kDivideInt:
    case Op::kDivideDouble:
    case Op::kRemainderInt:
    case Op::kRemainderDouble:
    case Op::kScale:
    case Op::kShrink:
    case Op::kRatio:
    case Op::kLessInt:
    case Op::kLessDouble:
    case Op::kLessString:
    case Op::kLessEqualInt:
    case Op::kLessEqualDouble:
    case Op::kLessEqualString:
    case Op::kEqualBool:
    case Op::kEqualInt:
    case Op::kEqualDouble:
    case Op::kEqualString:
    case Op::kMinInt:
    case Op::kMinDouble:
    case Op::kMaxInt:
    case Op::kMaxDouble:
    case Op::kPower:
      return 2;
  }
  return 0;
}

// Whether its operands are numbers or durations, and its result says how they are ordered.
bool compares_numbers(Op op);

struct Instruction {
  Op op = Op::kConstant;
  std::uint32_t operand = 0;  // of kConstant and kInput
};

// A constant of a program; as in Slot, with its text owned.
struct Constant {
  Slot slot;
  std::string text;
  Slot view() const;
};

struct Program {
  Type type = Type::kBool;  // of the result
  std::vector<Instruction> code;
  std::vector<Constant> constants;

  bool empty() const { return code.empty(); }
};

// Those of which one is enough to make it true: `a || b || c` has three, any other program is its only one. In no order.
std::vector<Program> alternatives(const Program& program);

// The stack of an evaluation. The checker refuses programs that need more.
inline constexpr std::size_t kStackSize = 512;

}  // namespace culprit
