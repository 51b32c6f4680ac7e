// Rule files of the reference manager, in either of its two dialects -> culprit's language.
//
// The meaning stays as near as the languages allow, and nothing gets lost silently. A part without
// an equivalent, or one that the reference itself reads otherwise than it is written, gets a
// comment at its place and a note. A rule that culprit's checks refuse is kept as a comment, with
// their words. Comments are kept.
#pragma once

#include <string>
#include <vector>

#include "base/expected.h"
#include "import/rule_writer.h"
#include "language/source.h"

namespace culprit::foreign {

// The largest file that is imported, in bytes.
inline constexpr std::size_t kMaxImport = 1u << 20;

struct Imported {
  std::string text;  // passes check()
  std::vector<Note> notes;
  std::size_t rules = 0;  // in the text
  std::size_t rules_as_comments = 0;
};

// Errors: the file is in neither dialect, or is malformed; with line and column, and what to do.
Expected<Imported> import_rules(const Source& source);

}  // namespace culprit::foreign
