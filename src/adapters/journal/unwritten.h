// The decisions and requests that the last run could not write into its journal any more: the rows
// of its intent file that the journal lacks.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "journal/intent_file.h"
#include "journal/reader.h"

namespace culprit::journal {

struct Unwritten {
  std::vector<Entry> rows;  // come after all rows of the journal; without `id`
  Time latest = kLongAgo;   // of their steps
  std::string remark;       // what is odd about the file; empty: nothing is
};

// `intents`: the file (intents_beside()). `journal`: the rows that it belongs to, wherever they are
// now. Leaves out the rows of a file that belongs to other rows, and those of a run that another
// one has followed: both are reported, or known to be over.
Unwritten unwritten_rows(const std::filesystem::path& intents, const Reader& journal);

}  // namespace culprit::journal
