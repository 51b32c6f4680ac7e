// Types one expression (language/typing.h): names and operators here, calls in call_typing.h.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "language/bare_words.h"
#include "language/diagnostic.h"
#include "language/symbols.h"
#include "language/syntax.h"
#include "language/typing.h"

namespace culprit {

class Typer {
 public:
  using Expression = syntax::Expression;

  // All are referred to, and must outlive the typer.
  Typer(const Expression& whole, Symbols& symbols, std::vector<Diagnostic>& diagnostics)
      : whole_(whole), symbols_(symbols), diagnostics_(diagnostics), bare_(symbols, diagnostics) {}

  // Nothing: the first mistake was reported. So it is with all that give nothing.
  std::optional<Typed> type(const Expression& e);

  Symbols& symbols() { return symbols_; }
  Typed input(Input wanted, Type type);
  std::nullopt_t unknown_type(const Expression& e);
  std::nullopt_t mismatch(const Expression& e, Type left, Type right, const std::string& verb);
  std::nullopt_t fail(Code code, Span span, std::string cause, std::string remedy,
                      std::optional<Edit> fix = {});

 private:
  std::optional<Typed> type_of(const Expression& e);
  std::optional<Typed> name(const Expression& e);
  std::optional<Typed> unary(const Expression& e);
  std::optional<Typed> conditional(const Expression& e);
  std::optional<Typed> binary(const Expression& e);
  bool is_call_without_parentheses(const Expression& e);
  std::optional<Typed> logic(const Expression& e, Op op, Typed&& left, Typed&& right);
  std::optional<Typed> compare(const Expression& e, Typed&& left, Typed&& right);
  std::optional<Typed> arithmetic(const Expression& e, Typed left, Typed right);
  std::optional<Typed> duration_arithmetic(const Expression& e, Typed left, Typed right);
  bool names_broken_constant(const Expression& e) const;

  const Expression& whole_;
  Symbols& symbols_;
  std::vector<Diagnostic>& diagnostics_;
  BareWords bare_;
  bool is_part_of_call_ = false;  // the name at hand, probably
};

bool is_exact(Type type);  // a whole number or a duration

template <class... Children>
Typed typed_node(Op op, Type type, Children&&... children) {
  Typed typed;
  typed.op = op;
  typed.type = type;
  // Moved one by one: a list in braces would copy whole trees.
  typed.children.reserve(sizeof...(children));
  (typed.children.push_back(std::move(children)), ...);
  return typed;
}

// Makes both of one type if a whole number may become a number. False: they differ.
bool make_alike(Typed& a, Typed& b);

}  // namespace culprit
