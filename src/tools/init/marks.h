// What of a rule file `culprit init` wrote, and whether it is as it was.
//
// A draft ends in comments with a mark for each of its components, rules and uses of packs: one number for what it
// is about, and one for its text. What no longer has the text of its mark is somebody's, who may also have
// taken it away; what has no mark at all the robot had not, or a person wrote it. How lines are laid out does
// not count, so `culprit fmt` changes nothing.
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

// Nothing of what is nobody's.
std::optional<Mark> mark_of(const Part& part);

// As the comments at the end of a file.
std::string text_of(const std::vector<Mark>& marks);

// A whole file of culprit's, with a mark in front by which is_as_written() knows later that nobody changed it.
// Here layout counts.
std::string with_mark(std::string_view text);
bool is_as_written(std::string_view text);

// Whether a line is one of those comments.
bool is_of_marks(std::string_view line);
// The marks in it. What is no mark is passed over.
std::vector<Mark> marks_in(std::string_view line);

}  // namespace culprit::init
