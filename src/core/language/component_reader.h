// The clauses of a COMPONENT line.
#pragma once

#include <span>
#include <string_view>

#include "language/line_reader.h"
#include "language/scanner.h"
#include "language/syntax.h"

namespace culprit {

// Their words, in the order of the documents.
std::span<const std::string_view> component_clauses();

// Reads the clauses behind the component's name, to the end of the line.
bool read_component_clauses(LineReader& read, const Source& source, Scanner& s,
                            syntax::Component& component);

}  // namespace culprit
