// What may be typed at a place.
#pragma once

#include <string>
#include <vector>

#include "lsp/document.h"

namespace culprit::lsp {

struct Proposal {
  enum class Kind : std::uint8_t { kKeyword, kFunction, kConstant, kSignal, kComponent, kTopic };
  Kind kind = Kind::kKeyword;
  std::string text;
  std::string detail;  // may be empty
  bool operator==(const Proposal&) const = default;
};

// Sorted by what fits, without regard to what is typed already: editors filter.
std::vector<Proposal> proposals(const Document& document, std::uint32_t offset);

}  // namespace culprit::lsp
