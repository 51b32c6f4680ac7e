// Operators and calls as other languages write them, with what is meant here.
//
// Each gives a diagnostic for what the parser has found; nothing: it is no such slip.
#pragma once

#include <optional>

#include "language/diagnostic.h"
#include "language/scanner.h"
#include "language/syntax.h"

namespace culprit {

// Two symbols that other languages write as one: "<>", ">>", "===", "**".
std::optional<Diagnostic> doubled_operator(const Token& first, const Token& second);

// An operator of another language, which `scanner` has next behind the value `left`: "=", "is", "not in".
std::optional<Diagnostic> foreign_operator(const syntax::Expression& left, const Scanner& scanner);

// "f"active"": Python's letter in front of a text; `scanner` is behind `word`.
std::optional<Diagnostic> letter_before_text(const Token& word, const Scanner& scanner);

// The word or sign that `scanner` has next behind a whole condition: "THEN", "unless", ",".
std::optional<Diagnostic> behind_condition(const Scanner& scanner);

// "alive camera": a function as other languages call it; `scanner` has its argument next. "age /scan" is
// a division (typing.cpp).
std::optional<Diagnostic> call_without_parentheses(const syntax::Expression& name,
                                                   const Scanner& scanner);

}  // namespace culprit
