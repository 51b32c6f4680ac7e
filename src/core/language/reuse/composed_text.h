// A text under construction whose parts know where they were written (text_origins.h).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "language/text_origins.h"

namespace culprit {

struct ComposedText {
  std::string text;
  std::vector<Piece> pieces;

  std::uint32_t size() const { return static_cast<std::uint32_t>(text.size()); }
  // Behind what is there: bytes that stand in one place, or for one.
  void add(std::string_view bytes, Piece piece);
  // A part of another text.
  void add(const ComposedText& other, Span part);
  // Bytes that stand for `part` of `other`.
  void add_instead(std::string_view bytes, const ComposedText& other, Span part);
};

// `text` instead of what stands at `span`, which may be empty.
struct Replacement {
  Span span;
  std::string text;
};

// @pre The spans do not overlap.
ComposedText replaced(const ComposedText& text, std::vector<Replacement> replacements);

}  // namespace culprit
