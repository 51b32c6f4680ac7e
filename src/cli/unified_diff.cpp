#include "cli/unified_diff.h"

#include <algorithm>

#include <fmt/core.h>

namespace culprit::cli {
namespace {

constexpr std::size_t kContext = 3;

// "3,7", as a hunk's head counts: the first line (from 1) and how many; the line before if none.
std::string range(std::size_t begin, std::size_t count) {
  const std::size_t first = count == 0 ? begin : begin + 1;
  return count == 1 ? std::to_string(first) : fmt::format("{},{}", first, count);
}

}  // namespace

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t length = std::min(text.find('\n'), text.size() - 1) + 1;
    lines.push_back(text.substr(0, length));
    text.remove_prefix(length);
  }
  return lines;
}

std::string unified_diff(std::string_view name, const std::vector<LineEdit>& edits) {
  const auto is_change = [](const LineEdit& e) { return e.sign != ' '; };
  if (std::ranges::none_of(edits, is_change)) return "";
  std::string out = fmt::format("--- {}\n+++ {}\n", name, name);
  std::size_t at = 0;
  std::size_t old_line = 0;
  std::size_t new_line = 0;
  const auto pass = [&](std::size_t end) {
    for (; at < end; ++at) {
      old_line += edits[at].sign != '+';
      new_line += edits[at].sign != '-';
    }
  };
  while (true) {
    auto change =
        std::find_if(edits.begin() + static_cast<std::ptrdiff_t>(at), edits.end(), is_change);
    if (change == edits.end()) return out;
    const auto first = static_cast<std::size_t>(change - edits.begin());
    const std::size_t begin = std::max(at, first - std::min(first, kContext));
    std::size_t last = first;
    for (std::size_t i = first; i < edits.size() && i <= last + 2 * kContext + 1; ++i) {
      if (is_change(edits[i])) last = i;
    }
    const std::size_t end = std::min(last + kContext + 1, edits.size());
    pass(begin);
    const std::size_t old_begin = old_line;
    const std::size_t new_begin = new_line;
    pass(end);
    out += fmt::format("@@ -{} +{} @@\n", range(old_begin, old_line - old_begin),
                       range(new_begin, new_line - new_begin));
    for (std::size_t i = begin; i < end; ++i) {
      out += edits[i].sign;
      out += edits[i].line;
      if (!edits[i].line.ends_with('\n')) out += "\n\\ No newline at end of file\n";
    }
  }
}

}  // namespace culprit::cli
