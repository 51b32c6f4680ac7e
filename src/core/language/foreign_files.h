// Files that are written in another language, and comments of other languages.
#pragma once

#include <vector>

#include "language/diagnostic.h"
#include "language/source.h"

namespace culprit {

// One mistake, one message. It leaves one error about a file of another kind: JSON, YAML, XML, Python, a configuration,
// a test of rules, or binary. It also leaves one about a comment of several lines, and about a block in braces. The other
// `diagnostics` stay.
void condense(const Source& source, std::vector<Diagnostic>& diagnostics);

}  // namespace culprit
