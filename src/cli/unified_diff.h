// Lines that went and lines that came, as `patch` reads them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace culprit::cli {

// A line with its line end, if it has one; its sign is ' ', '-' or '+'.
struct LineEdit {
  char sign;
  std::string_view line;
};

// With their line ends, so that those are compared too.
std::vector<std::string_view> lines_of(std::string_view text);

// All lines of both texts, in order. Empty if all are the same.
std::string unified_diff(std::string_view name, const std::vector<LineEdit>& edits);

}  // namespace culprit::cli
