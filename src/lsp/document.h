// One open rule file: its text, what it says, and what is wrong with it.
#pragma once

#include <string>
#include <vector>

#include "language/checker.h"
#include "language/occurrences.h"
#include "language/source.h"
#include "language/syntax.h"

namespace culprit::lsp {

struct Document {
  explicit Document(std::string text);

  Source source;
  syntax::File file;
  Checked checked;
  std::vector<Occurrence> names;
};

}  // namespace culprit::lsp
