// Files that are written in another language, and comments of other languages.
#pragma once

#include <vector>

#include "language/diagnostic.h"
#include "language/source.h"

namespace culprit {

// One mistake, one message: leaves one error about a file that is JSON, YAML, XML, Python, a test of rules, a configuration or binary,
// and one about a comment of several lines or a block in braces. Keeps the other `diagnostics`.
void condense(const Source& source, std::vector<Diagnostic>& diagnostics);

}  // namespace culprit
