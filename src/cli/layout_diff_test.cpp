#include "cli/layout_diff.h"

#include <cstdio>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "language/formatter.h"

namespace culprit::cli {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
    lines.push_back(text.substr(at, end - at));
    at = end;
  }
  return lines;
}

// Applies a diff as the plainest reader would, and checks its context against `before`.
std::string patched(const std::string& before, const std::string& diff) {
  const auto olds = lines_of(before);
  std::vector<std::string> edits = lines_of(diff);
  std::string out;
  std::size_t at = 0;
  for (std::size_t i = 2; i < edits.size(); ++i) {
    if (i + 1 < edits.size() && edits[i + 1].starts_with('\\')) edits[i].pop_back();
    const std::string line = edits[i].substr(1);
    std::size_t first = 0;
    std::size_t count = 1;
    switch (edits[i][0]) {
      case '@':
        std::sscanf(edits[i].c_str(), "@@ -%zu,%zu", &first, &count);
        for (; at + (count > 0 ? 1 : 0) < first; ++at) out += olds.at(at);
        break;
      case '\\':
        break;
      case '+':
        out += line;
        break;
      default:
        EXPECT_EQ(olds.at(at), line);
        if (edits[i][0] == ' ') out += line;
        ++at;
    }
  }
  for (; at < olds.size(); ++at) out += olds[at];
  return out;
}

TEST(LayoutDiff, IsEmptyForTheSame) { EXPECT_EQ(layout_diff("a", "x\n", "x\n"), ""); }

TEST(LayoutDiff, ShowsAMissingLineEnd) {
  EXPECT_EQ(layout_diff("a", "ROBOT r", "ROBOT r\n"),
            "--- a\n+++ a\n@@ -1 +1 @@\n-ROBOT r\n\\ No newline at end of file\n+ROBOT r\n");
}

TEST(LayoutDiff, PartsWhatIsFarApart) {
  std::string before = "ROBOT  r\n";
  for (int i = 0; i < 7; ++i) before += "# c\n";
  const std::string near = before.substr(0, before.size() - 4);
  const auto hunks = [](const std::string& text) {
    const std::string diff = layout_diff("a", text, *format(Source("a", text)));
    std::size_t count = 0;
    for (std::size_t at = diff.find("@@ -"); at != std::string::npos;
         at = diff.find("@@ -", at + 1))
      ++count;
    return count;
  };
  EXPECT_EQ(hunks(near + "CYCLE  1s\n"), 1u);
  EXPECT_EQ(hunks(before + "CYCLE  1s\n"), 2u);
}

RC_GTEST_PROP(LayoutDiff, LeadsFromTheTextToItsLayout, ()) {
  std::string before = *rc::gen::element("", "\xEF\xBB\xBF", "\n", "\xEF\xBB\xBF\n");
  for (int n = *rc::gen::inRange(0, 60); n > 0; --n) {
    before +=
        *rc::gen::element("", "", " ", "# c", "  # d", "CONST a=1", "CONST b = 1", "CONST b2 = 1");
    before += *rc::gen::element("\n", "\n", "\n", "\r\n");
  }
  before += *rc::gen::element("", "# e", " ");
  const std::string after = *format(Source("a", before));
  RC_ASSERT(patched(before, layout_diff("a", before, after)) == after);
}

}  // namespace
}  // namespace culprit::cli
