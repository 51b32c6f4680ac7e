// A reference file -> culprit's language, as blocks of lines.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "import/foreign_rules.h"

namespace culprit::foreign {

// Lines that are kept or put into a comment together: one declaration, or one rule.
struct Block {
  std::uint32_t line = 0;  // of the file that is imported; 0: of no line
  bool is_rule = false;
  std::vector<std::string> comments;  // above
  std::vector<std::string> notes;     // above, too: what a person should know
  std::vector<std::string> lines;
};

struct Note {
  std::uint32_t line = 0;  // of the file that is imported; 0: of the whole file
  std::string text;
};

struct Written {
  std::vector<Block> blocks;
  std::vector<Note> notes;  // all that the blocks say, too, in the order of the file
};

// `name`: what messages call the file.
Written write(const File& file, const std::string& name);

}  // namespace culprit::foreign
