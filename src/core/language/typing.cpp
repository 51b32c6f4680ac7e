#include "language/typing.h"

#include "language/typer.h"

namespace culprit {

std::optional<Typed> type_expression(const syntax::Expression& expression, Symbols& symbols,
                                     std::vector<Diagnostic>& diagnostics) {
  return Typer(expression, symbols, diagnostics).type(expression);
}

std::optional<Typed> converted(Typed typed, Type wanted) {
  if (typed.type == wanted) return typed;
  if (typed.type == Type::kInt && wanted == Type::kDouble) {
    return typed_node(Op::kIntToDouble, Type::kDouble, std::move(typed));
  }
  return std::nullopt;
}

bool is_numeric(Type type) { return type == Type::kInt || type == Type::kDouble; }

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
