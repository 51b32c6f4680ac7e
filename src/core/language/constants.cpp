#include "language/constants.h"

#include <algorithm>
#include <string>
#include <utility>
#include <variant>

#include "language/compiler.h"
#include "language/evaluate.h"
#include "language/typing.h"

namespace culprit {
namespace {

class ConstantValues {
 public:
  ConstantValues(Symbols& symbols, std::vector<Diagnostic>& diagnostics)
      : symbols_(symbols), diagnostics_(diagnostics) {}

  std::optional<syntax::Literal> value_of(const syntax::Constant& constant) {
    if (is_comment(constant.value) || names_a_signal(constant.value)) return std::nullopt;
    const auto typed = type_expression(constant.value, symbols_, diagnostics_);
    if (!typed) return std::nullopt;
    if (reads_inputs(*typed)) {
      report(Code::kNotConstant, constant.value.span, "this changes at run time",
             "a constant is made of constants");
      return std::nullopt;
    }
    const Program program = compile(*typed);  // the slot borrows its text
    const Slot slot = evaluate(program, {});
    if (!slot.known) {
      report(Code::kNoValue, constant.value.span, "this has no value",
             "it divides by zero or overflows");
      return std::nullopt;
    }
    if (typed->type == Type::kDuration) return Duration(slot.i);
    return std::visit([](const auto& value) -> syntax::Literal { return value; },
                      to_value(slot, typed->type));
  }

 private:
  // "75.0 -- degrees", which reads as two signs
  bool is_comment(const syntax::Expression& e) {
    if (e.kind != syntax::Expression::Kind::kBinary || e.op != syntax::Operator::kSubtract)
      return false;
    const syntax::Expression& right = e.children[1];
    const std::uint32_t signs = right.span.begin - 1;
    const bool is_so =
        right.kind == syntax::Expression::Kind::kUnary && right.op == syntax::Operator::kNegate &&
        right.children[0].kind == syntax::Expression::Kind::kName &&
        e.children[0].span.end + 1 == signs && right.children[0].span.begin > signs + 2 &&
        !symbols_.constant(right.children[0].name.text);
    if (is_so)
      diagnostics_.push_back({Code::kExtraText,
                              Severity::kError,
                              {signs, signs + 2},
                              "no comment begins with '--'",
                              "begin a comment with #",
                              Edit{{signs, signs + 2}, "#"}});
    return is_so;
  }

  // A constant must not create signals by naming them.
  bool names_a_signal(const syntax::Expression& e) {
    if (e.kind == syntax::Expression::Kind::kCall || e.kind == syntax::Expression::Kind::kName) {
      const auto* constant = symbols_.constant(e.name.text);
      const bool is_name = e.kind == syntax::Expression::Kind::kName;
      const bool pure = e.name.text == "abs" || e.name.text == "min" || e.name.text == "max" ||
                        e.name.text == "pow" || e.name.text == "sqrt";
      if (is_name ? constant == nullptr : !pure) {
        report(Code::kNotConstant, e.span, "'" + e.name.text + "' is no constant",
               "a constant is made of numbers, texts and constants");
        return true;
      }
      if (is_name && constant->broken) {
        report(Code::kNotConstant, e.span, "'" + e.name.text + "' has no value yet",
               "define it in a line before this one");
        return true;
      }
    }
    return std::any_of(e.children.begin(), e.children.end(),
                       [&](const auto& c) { return names_a_signal(c); });
  }

  void report(Code code, Span span, std::string cause, std::string remedy) {
    diagnostics_.push_back({code, Severity::kError, span, std::move(cause), std::move(remedy)});
  }

  Symbols& symbols_;
  std::vector<Diagnostic>& diagnostics_;
};

}  // namespace

void define_constants(const syntax::File& file, Symbols& symbols,
                      std::vector<Diagnostic>& diagnostics) {
  for (const syntax::Constant& constant : file.constants) {
    if (const auto* known = symbols.constant(constant.name.text);
        known != nullptr && !known->broken)
      continue;
    if (auto value = constant_value(constant, symbols, diagnostics))
      symbols.define_constant(constant.name, {std::move(*value), false});
  }
}

std::optional<syntax::Literal> constant_value(const syntax::Constant& constant, Symbols& symbols,
                                              std::vector<Diagnostic>& diagnostics) {
  return ConstantValues(symbols, diagnostics).value_of(constant);
}

}  // namespace culprit
