#include "language/program.h"

#include <cmath>

namespace culprit {
namespace {

// Where the code of the last operand of an instruction before `end` begins.
std::size_t last_operand(const std::vector<Instruction>& code, std::size_t end) {
  std::size_t wanted = 1;
  while (wanted > 0) {
    --end;
    wanted += static_cast<std::size_t>(operand_count(code[end].op));
    --wanted;
  }
  return end;
}

// Adds those of the code in [begin, end).
void add_alternatives(const Program& program, std::size_t begin, std::size_t end,
                      std::vector<Program>& to) {
  while (program.code[end - 1].op == Op::kOr) {
    const std::size_t right = last_operand(program.code, end - 1);
    add_alternatives(program, right, end - 1, to);
    end = right;
  }
  const auto at = [&](std::size_t i) {
    return program.code.begin() + static_cast<std::ptrdiff_t>(i);
  };
  to.push_back({program.type, {at(begin), at(end)}, program.constants});
}

}  // namespace

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

std::vector<Program> alternatives(const Program& program) {
  std::vector<Program> all;
  if (!program.empty()) add_alternatives(program, 0, program.code.size(), all);
  return all;
}

}  // namespace culprit
