// The description of a name, for the reader who points at it.
#pragma once

#include <string>

#include "lsp/document.h"

namespace culprit::lsp {

// In Markdown; empty if there is none. Its current state is added if `robot` is not null.
std::string hover(const Document& document, const Occurrence& thing,
                  const LiveInventory* robot = nullptr);

}  // namespace culprit::lsp
