// Whether a journal is still what was written.
//
// The chain shows every row that was changed, removed or inserted, but not rows removed from its
// end: to detect that, note the newest row and its hash elsewhere, and name them here.
#pragma once

#include "journal/reader.h"

namespace culprit::journal {

struct Verification {
  std::int64_t rows = 0;
  std::int64_t first = 0;  // ids
  Link newest;
  std::vector<std::string> findings;  // empty: all is as it was written
};

// `noted`: a row that must be in the chain with this hash. Errors: the file cannot be read.
Expected<Verification> verify(const Reader& journal, const std::optional<Link>& noted = {});

}  // namespace culprit::journal
