// Places in a text as editors count them: lines from 0, and UTF-16 code units from 0 (LSP 3.17,
// "Position").
#pragma once

#include <compare>
#include <cstdint>

#include "language/source.h"

namespace culprit::lsp {

struct TextPosition {
  std::uint32_t line = 0;
  std::uint32_t character = 0;
  auto operator<=>(const TextPosition&) const = default;
};

TextPosition text_position(const Source& source, std::uint32_t offset);

// The byte offset of a place. A place behind the end of its line is that end, one behind the last
// line is the end of the text.
std::uint32_t offset_of(const Source& source, TextPosition position);

}  // namespace culprit::lsp
