// Syntax trees for comparison: what a rule text says, without how and where it is written.
#pragma once

#include <string>

#include "language/syntax.h"

namespace culprit {

// Equal for two files exactly if their trees are equal but for the places in the text.
std::string tree_text(const syntax::File& file);

}  // namespace culprit
