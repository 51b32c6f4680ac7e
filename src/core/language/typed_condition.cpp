#include "language/typed_condition.h"

#include "language/compiler.h"

namespace culprit {
namespace {

std::string remedy_of_no_condition(const Typed& typed, const syntax::Expression& e) {
  if (typed.type == Type::kDuration) return "compare it with a duration, as in age(/topic) > 1s";
  if (typed.type != Type::kString) return "compare it with something, as in rate(/topic) < 1";
  return e.kind == syntax::Expression::Kind::kLiteral
             ? "write the condition without quotes"
             : "compare it with a text, as in lifecycle(camera) != \"active\"";
}

}  // namespace

std::optional<Typed> typed_condition(const syntax::Expression& e, const std::string& what,
                                     Symbols& symbols, std::vector<Diagnostic>& diagnostics) {
  auto typed = type_expression(e, symbols, diagnostics);
  if (!typed || !fits_stack(*typed, e, diagnostics)) return std::nullopt;
  if (typed->type == Type::kBool) return typed;
  diagnostics.push_back({Code::kTypeMismatch, Severity::kError, e.span,
                         what + " is true or false; this is " + describe(typed->type),
                         remedy_of_no_condition(*typed, e)});
  return std::nullopt;
}

bool fits_stack(const Typed& typed, const syntax::Expression& e,
                std::vector<Diagnostic>& diagnostics) {
  if (stack_need(typed) <= kStackSize) return true;
  diagnostics.push_back({Code::kTooDeep, Severity::kError, e.span,
                         "this expression is nested too deeply", "split it into several rules"});
  return false;
}

}  // namespace culprit
