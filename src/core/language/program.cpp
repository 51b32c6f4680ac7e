#include "language/program.h"

#include <cmath>

namespace culprit {

Slot Slot::of(bool value) {
  Slot slot;
  slot.b = value;
  slot.known = true;
  return slot;
}

Slot Slot::of(std::int64_t value) {
  Slot slot;
  slot.i = value;
  slot.known = true;
  return slot;
}

Slot Slot::of(double value) {
  Slot slot;
  slot.d = value;
  slot.known = !std::isnan(value);
  return slot;
}

Slot Slot::of(std::string_view value) {
  Slot slot;
  slot.s = value;
  slot.known = true;
  return slot;
}

bool compares_numbers(Op op) {
  switch (op) {
    case Op::kLessInt:
    case Op::kLessDouble:
    case Op::kLessEqualInt:
    case Op::kLessEqualDouble:
    case Op::kEqualInt:
    case Op::kEqualDouble:
      return true;
    default:
      return false;
  }
}

Slot Constant::view() const {
  Slot out = slot;
  out.s = text;
  return out;
}

std::string_view to_string(Type type) {
  switch (type) {
    case Type::kBool:
      return "bool";
    case Type::kInt:
      return "int";
    case Type::kDouble:
      return "double";
    case Type::kString:
      return "string";
    case Type::kDuration:
      return "duration";
  }
  return "";
}

}  // namespace culprit
