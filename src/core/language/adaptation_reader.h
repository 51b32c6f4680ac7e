// The words behind the keyword of an ADAPTATION line: "fusion set_parameter recalibration true 2".
#pragma once

#include <optional>

#include "language/line_reader.h"
#include "language/scanner.h"
#include "language/source.h"
#include "language/syntax.h"

namespace culprit {

// Empty: it is not understood, and was reported. The span begins with the component.
std::optional<syntax::Adaptation> read_adaptation(LineReader& read, const Source& source,
                                                  Scanner& s);

}  // namespace culprit
