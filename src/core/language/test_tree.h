// Syntax trees for comparison: what a rule text says, without how and where it is written.
#pragma once

#include <cstdint>
#include <string>

#include "language/syntax.h"

namespace culprit {

enum class Places : std::uint8_t { kLeftOut, kShown };

// Equal for two files exactly if their trees are equal, but for the places in the text if those are
// left out, and declarations that do not parse.
std::string tree_text(const syntax::File& file, Places places = Places::kLeftOut);

}  // namespace culprit
