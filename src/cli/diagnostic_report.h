// The diagnostics of a check, for programs: editors, scripts, and viewers that show it beside the
// code.
//
// Lines and columns count from 1, columns in characters; ends are exclusive.
#pragma once

#include <vector>

#include "json/json.h"
#include "language/diagnostic.h"
#include "language/source.h"

namespace culprit::cli {

struct CheckedFile {
  Source source;
  std::vector<Diagnostic> diagnostics;
};

// An array of {file, code, severity, line, column, end_line, end_column, cause, remedy}, in the
// order of the files and of their text; with notes, [{note, file, line, ...}], of what is included
// or used.
Json json_report(const std::vector<CheckedFile>& files);

// SARIF 2.1.0 (OASIS), one run. Every code is a rule, found or not.
Json sarif_report(const std::vector<CheckedFile>& files);

// `document` as text. Invalid UTF-8 in a rule file becomes U+FFFD.
std::string to_text(const Json& document);

}  // namespace culprit::cli
