// Expressions get their types: syntax tree -> typed tree, in two passes.
//
// Constants, literals and functions have types of their own; signals and parameters get theirs from
// how they are used (`x > 0.5` makes x a number, `x == "dock"` a text, `x` alone true or false, and
// `x == y` whatever the other one is). So all expressions of a file are first walked to learn
// (`infer_types`), and then typed one by one (`type_expression`).
#pragma once

#include <optional>
#include <vector>

#include "base/seldom.h"
#include "language/diagnostic.h"
#include "language/program.h"
#include "language/symbols.h"
#include "language/syntax.h"

namespace culprit {

// A node that knows its instruction. Leaves are kConstant and kInput; otherwise the children are
// the operands.
struct Typed {
  Op op = Op::kConstant;
  Type type = Type::kBool;
  InputId input;
  Span span;                  // of a condition (type kBool): where it is written
  Seldom<Constant> constant;  // there if op is kConstant
  std::vector<Typed> children;
};

// Learns types of signals and parameters from `expression`, which is wanted to be of type `wanted`
// (nothing: any).
void infer_types(const syntax::Expression& expression, std::optional<Type> wanted,
                 Symbols& symbols);

// Reports the first mistake and gives nothing if the expression has no type.
std::optional<Typed> type_expression(const syntax::Expression& expression, Symbols& symbols,
                                     std::vector<Diagnostic>& diagnostics);

// `typed` as a `wanted`: itself, or a whole number as a number. Empty if that cannot be.
std::optional<Typed> converted(Typed typed, Type wanted);

bool is_numeric(Type type);  // a whole number or a number

// For messages: "a number", "true or false".
const char* describe(Type type);

}  // namespace culprit
