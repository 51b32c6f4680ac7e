// Finds the parts of a rule file that `culprit init` wrote, and whether they are unchanged.
//
// A draft ends in comments with a mark for each of its components, rules and uses of packs: a hash of its subject, and one of its text. A part with another
// text than its mark was changed by a person, and one that is missing was removed by a person. A part without a mark is new on the robot, or written by a
// person. Layout does not count, so `culprit fmt` changes nothing.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "init/part.h"

namespace culprit::init {

struct Mark {
  std::uint32_t about = 0;
  std::uint32_t text = 0;
  bool operator==(const Mark&) const = default;
};

// FNV-1a over the words.
std::uint32_t print_of(std::string_view text);

// Empty for a part without a mark.
std::optional<Mark> mark_of(const Part& part);

// As the comments at the end of a file.
std::string text_of(const std::vector<Mark>& marks);

// A whole file of culprit's, with a mark in front by which is_as_written() finds out later whether it was changed. Here layout counts.
std::string with_mark(std::string_view text);
bool is_as_written(std::string_view text);

// Whether a line is one of those comments.
bool is_of_marks(std::string_view line);
// The marks in it. Any other text is ignored.
std::vector<Mark> marks_in(std::string_view line);

}  // namespace culprit::init
