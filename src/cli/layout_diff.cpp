#include "cli/layout_diff.h"

#include <algorithm>
#include <vector>

#include "cli/unified_diff.h"
#include "language/scanner.h"

namespace culprit::cli {
namespace {

bool shows_nothing(std::string_view line) {
  if (line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
  return std::all_of(line.begin(), line.end(), [](char c) { return c == '\n' || is_blank(c); });
}

std::vector<LineEdit> edits_of(std::string_view before, std::string_view after) {
  const auto olds = lines_of(before);
  const auto news = lines_of(after);
  std::vector<LineEdit> edits;
  std::vector<LineEdit> added;  // behind the removed lines that they replace
  const auto flush = [&] {
    edits.insert(edits.end(), added.begin(), added.end());
    added.clear();
  };
  auto next = news.begin();
  for (const std::string_view old : olds) {
    const bool left_out = next == news.end() || (shows_nothing(old) && !shows_nothing(*next));
    if (!left_out && old == *next) {
      flush();
      edits.push_back({' ', old});
    } else {
      edits.push_back({'-', old});
      if (!left_out) added.push_back({'+', *next});
    }
    if (!left_out) ++next;
  }
  flush();
  return edits;
}

}  // namespace

std::string layout_diff(std::string_view name, std::string_view before, std::string_view after) {
  return before == after ? "" : unified_diff(name, edits_of(before, after));
}

}  // namespace culprit::cli
