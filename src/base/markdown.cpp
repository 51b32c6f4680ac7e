#include "base/markdown.h"

#include <algorithm>

namespace culprit {

std::vector<MarkdownSection> markdown_sections(std::string_view page) {
  constexpr std::string_view kMark = "\n## ";
  std::vector<MarkdownSection> sections;
  for (auto at = page.find(kMark); at != std::string_view::npos;) {
    page.remove_prefix(at + kMark.size());
    at = page.find(kMark);
    const std::string_view section = page.substr(0, at);
    const auto end = std::min(section.find('\n'), section.size());
    sections.push_back({section.substr(0, end), section.substr(end)});
  }
  return sections;
}

std::string_view text_between(std::string_view text, std::string_view from, std::string_view to) {
  const auto begin = text.find(from);
  if (begin == std::string_view::npos) return {};
  text.remove_prefix(begin + from.size());
  return text.substr(0, text.find(to));
}

std::string indented_code(std::string_view text) {
  constexpr std::string_view kBlanks = "    ";
  std::string code;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.starts_with(kBlanks)) code.append(line.substr(kBlanks.size())).append("\n");
  }
  return code;
}

}  // namespace culprit
