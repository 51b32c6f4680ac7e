// Lines that begin with no word of the language: what their author most likely meant.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "language/line_reader.h"
#include "language/scanner.h"
#include "language/source.h"

namespace culprit {

struct UnknownLine {
  const Source& source;
  LineReader& read;
  std::span<const std::string_view> keywords;  // with which statements begin
  bool is_in_rule;
  bool has_trigger;          // that rule
  bool is_below_unfinished;  // the line above was reported, and may go on in this one
};

// Reports the line that begins with `head`; `s` is behind it. Gives the keyword that was meant, if
// the line can be read as its statement; else nothing.
std::string report_unknown_line(const UnknownLine& line, const Token& head, const Scanner& s);

// Whether the statement of `line` goes on in the next line, as other languages allow.
bool is_unfinished(std::string_view line);

}  // namespace culprit
