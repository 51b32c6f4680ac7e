// Completion: the proposals at a place.
#pragma once

#include <string>
#include <vector>

#include "language/live_inventory.h"
#include "lsp/document.h"

namespace culprit::lsp {

struct Proposal {
  enum class Kind : std::uint8_t {
    kKeyword,
    kFunction,
    kConstant,
    kSignal,
    kComponent,
    kTopic,
    kParameter,
    kService,
    kStatus,
    kTemplate,
    kFile
  };
  Kind kind = Kind::kKeyword;
  std::string text;
  std::string detail;  // may be empty
  bool operator==(const Proposal&) const = default;
};

// Sorted by what fits, without regard to what is typed already: editors filter. `robot` may be
// null; `files` are what an INCLUDE could name.
std::vector<Proposal> proposals(const Document& document, std::uint32_t offset,
                                const LiveInventory* robot = nullptr,
                                const std::vector<std::string>& files = {});

// The text that an editor must replace by the proposal: the part of it that is typed already.
Span typed_part(const Document& document, std::uint32_t offset, const Proposal& proposal);

}  // namespace culprit::lsp
