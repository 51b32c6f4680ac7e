#include "language/evaluate.h"

#include <cmath>
#include <cstring>

#include "base/invariant.h"

namespace culprit {
namespace {

Slot finite(double d) { return std::isfinite(d) ? Slot::of(d) : Slot(); }

Slot rounded(double d) {
  constexpr double kLimit = 9223372036854775808.0;  // 2^63
  const double r = std::nearbyint(d);
  return r >= -kLimit && r < kLimit ? Slot::of(static_cast<std::int64_t>(r)) : Slot();
}

template <bool (*overflows)(std::int64_t, std::int64_t, std::int64_t*)>
Slot exact(std::int64_t a, std::int64_t b) {
  std::int64_t result = 0;
  return overflows(a, b, &result) ? Slot() : Slot::of(result);
}
bool add(std::int64_t a, std::int64_t b, std::int64_t* r) {
  return __builtin_add_overflow(a, b, r);
}
bool subtract(std::int64_t a, std::int64_t b, std::int64_t* r) {
  return __builtin_sub_overflow(a, b, r);
}
bool multiply(std::int64_t a, std::int64_t b, std::int64_t* r) {
  return __builtin_mul_overflow(a, b, r);
}

bool divisible(std::int64_t a, std::int64_t b) { return b != 0 && !(b == -1 && a == INT64_MIN); }

Slot unary(Op op, const Slot& a) {
  if (!a.known) return {};
  switch (op) {
    case Op::kIntToDouble:
      return Slot::of(static_cast<double>(a.i));
    case Op::kNot:
      return Slot::of(!a.b);
    case Op::kNegateInt:
      return exact<subtract>(0, a.i);
    case Op::kNegateDouble:
      return Slot::of(-a.d);
    case Op::kAbsInt:
      return a.i < 0 ? exact<subtract>(0, a.i) : a;
    case Op::kAbsDouble:
      return Slot::of(std::fabs(a.d));
    case Op::kSquareRoot:
      return finite(std::sqrt(a.d));
    default:
      CULPRIT_ASSERT(false);  // each instruction of one operand is here
      return {};
  }
}

// @pre both known
Slot arithmetic(Op op, const Slot& a, const Slot& b) {
  CULPRIT_ASSERT(a.known && b.known);
  switch (op) {
    case Op::kAddInt:
      return exact<add>(a.i, b.i);
    case Op::kAddDouble:
      return finite(a.d + b.d);
    case Op::kSubtractInt:
      return exact<subtract>(a.i, b.i);
    case Op::kSubtractDouble:
      return finite(a.d - b.d);
    case Op::kMultiplyInt:
      return exact<multiply>(a.i, b.i);
    case Op::kMultiplyDouble:
      return finite(a.d * b.d);
    case Op::kDivideInt:
      return divisible(a.i, b.i) ? Slot::of(a.i / b.i) : Slot();
    case Op::kDivideDouble:
      return finite(a.d / b.d);
    case Op::kRemainderInt:
      return divisible(a.i, b.i) ? Slot::of(a.i % b.i) : Slot();
    case Op::kRemainderDouble:
      return finite(std::fmod(a.d, b.d));
    case Op::kScale:
      return rounded(static_cast<double>(a.i) * b.d);
    case Op::kShrink:
      return rounded(static_cast<double>(a.i) / b.d);
    case Op::kRatio:
      return finite(static_cast<double>(a.i) / static_cast<double>(b.i));
    case Op::kPower:
      return finite(std::pow(a.d, b.d));
    case Op::kMinInt:
      return a.i < b.i ? a : b;
    case Op::kMinDouble:
      return a.d < b.d ? a : b;
    case Op::kMaxInt:
      return a.i < b.i ? b : a;
    case Op::kMaxDouble:
      return a.d < b.d ? b : a;
    default:
      CULPRIT_ASSERT(false);  // each instruction of two operands is here or in a caller
      return {};
  }
}

// @pre both known
Slot comparison(Op op, const Slot& a, const Slot& b) {
  CULPRIT_ASSERT(a.known && b.known);
  switch (op) {
    case Op::kLessInt:
      return Slot::of(a.i < b.i);
    case Op::kLessDouble:
      return Slot::of(a.d < b.d);
    case Op::kLessString:
      return Slot::of(a.s < b.s);
    case Op::kLessEqualInt:
      return Slot::of(a.i <= b.i);
    case Op::kLessEqualDouble:
      return Slot::of(a.d <= b.d);
    case Op::kLessEqualString:
      return Slot::of(a.s <= b.s);
    case Op::kEqualBool:
      return Slot::of(a.b == b.b);
    case Op::kEqualInt:
      return Slot::of(a.i == b.i);
    case Op::kEqualDouble:
      return Slot::of(a.d == b.d);
    case Op::kEqualString:
      return Slot::of(a.s == b.s);
    default:
      return arithmetic(op, a, b);
  }
}

// The dominant value (false for &&, true for ||) decides alone; otherwise both must be known.
Slot logic(const Slot& a, const Slot& b, bool dominant) {
  if ((a.known && a.b == dominant) || (b.known && b.b == dominant)) return Slot::of(dominant);
  return a.known && b.known ? Slot::of(!dominant) : Slot();
}

Slot binary(Op op, const Slot& a, const Slot& b) {
  if (op == Op::kAnd) return logic(a, b, false);
  if (op == Op::kOr) return logic(a, b, true);
  return a.known && b.known ? comparison(op, a, b) : Slot();
}

// `read` gives the value of an input by its number.
template <class Read>
Slot run(const Program& program, Read read) {
  // Left uninitialised on purpose: a trigger uses a few of these slots, and clearing all would cost
  // more than running it.
  alignas(Slot) std::byte memory[kStackSize * sizeof(Slot)];
  Slot* top = reinterpret_cast<Slot*>(memory);
  for (const Instruction& instruction : program.code) {
    switch (instruction.op) {
      case Op::kConstant:
        new (top++) Slot(program.constants[instruction.operand].view());
        continue;
      case Op::kInput:
        new (top++) Slot(read(instruction.operand));
        continue;
      case Op::kSelect:
        top -= 2;
        top[-1] = top[-1].known ? (top[-1].b ? top[0] : top[1]) : Slot();
        continue;
      default:
        break;
    }
    if (operand_count(instruction.op) == 1) {
      top[-1] = unary(instruction.op, top[-1]);
    } else {
      --top;
      top[-1] = binary(instruction.op, top[-1], top[0]);
    }
  }
  return program.code.empty() ? Slot() : top[-1];
}

}  // namespace

Slot evaluate(const Program& program, std::span<const Slot> inputs) {
  return run(program, [inputs](std::uint32_t input) -> const Slot& { return inputs[input]; });
}

Slot evaluate(const Program& program, std::span<const Slot> inputs,
              std::span<const Assumed> assumed) {
  return run(program, [&](std::uint32_t input) -> const Slot& {
    for (const Assumed& each : assumed) {
      if (each.input.index == input) return each.value;
    }
    return inputs[input];
  });
}

Value to_value(const Slot& slot, Type type) {
  switch (type) {
    case Type::kBool:
      return slot.b;
    case Type::kInt:
      return slot.i;
    case Type::kDouble:
      return slot.d;
    case Type::kString:
      return std::string(slot.s);
    case Type::kDuration:
      return seconds(Duration(slot.i));
  }
  return false;
}

}  // namespace culprit
