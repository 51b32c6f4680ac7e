// Expressions as culprit writes them: parentheses only where its precedence needs them.
#pragma once

#include <functional>
#include <string>

#include "language/syntax.h"

namespace culprit::foreign {

// The text that stands for a name of the reference, and whether its value is a whole number.
// culprit divides whole numbers without a remainder, the reference never does.
struct Meaning {
  std::string text;
  bool is_whole = false;
};
using Meanings = std::function<Meaning(const std::string& name)>;

std::string expression_text(const syntax::Expression& expression, const Meanings& meanings);

std::string literal_text(const syntax::Literal& literal);

}  // namespace culprit::foreign
