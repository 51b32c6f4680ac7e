// What a thing is, for the reader who points at it.
#pragma once

#include <string>

#include "lsp/document.h"

namespace culprit::lsp {

// In Markdown; empty if there is nothing to say.
std::string hover(const Document& document, const Occurrence& thing);

}  // namespace culprit::lsp
