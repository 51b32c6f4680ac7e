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
  kIntToDouble,  // i -> d
  kNot,
  kAnd,
  kOr,
  kSelect,  // condition, then, otherwise -> one of the two
  kNegateInt,
  kNegateDouble,
  kAddInt,  // the Int instructions also serve durations
  kAddDouble,
  kSubtractInt,
  kSubtractDouble,
  kMultiplyInt,
  kMultiplyDouble,
  kDivideInt,  // toward zero, as in C++
  kDivideDouble,
  kRemainderInt,  // sign of the dividend, as in C++
  kRemainderDouble,
  kScale,   // duration, double -> duration
  kShrink,  // duration, double -> duration
  kRatio,   // duration, duration -> double
  kLessInt,
  kLessDouble,
  kLessString,  // byte by byte
  kLessEqualInt,
  kLessEqualDouble,
  kLessEqualString,
  kEqualBool,
  kEqualInt,
  kEqualDouble,
  kEqualString,
  kAbsInt,
  kAbsDouble,
  kMinInt,
  kMinDouble,
  kMaxInt,
  kMaxDouble,
  kPower,
  kSquareRoot,
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
    default:
      return 2;
  }
}

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

// The stack of an evaluation. The checker refuses programs that need more.
inline constexpr std::size_t kStackSize = 512;

}  // namespace culprit
