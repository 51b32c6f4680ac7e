#include "language/explanations.h"

#include <algorithm>
#include <charconv>

#include "base/markdown.h"
#include "base/wrapped.h"
#include "language/diagnostics_text.h"

namespace culprit {
namespace {

std::optional<Code> code_of(std::string_view text) {
  if (text.starts_with('R') || text.starts_with('r')) text.remove_prefix(1);
  std::uint16_t number = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || rest != text.data() + text.size()) return std::nullopt;
  return static_cast<Code>(number);
}

std::vector<Explanation> explanations_in(std::string_view page) {
  std::vector<Explanation> all;
  for (const auto& [heading, text] : markdown_sections(page)) {
    const auto code = code_of(heading);
    if (!code) continue;
    all.push_back({*code, std::string(text_between(text, "**", ".** ")),
                   std::string(text_between(text, ".** ", "\n\nWrong:\n")),
                   indented_code(text_between(text, "\n\nWrong:\n", "\nRight:\n")),
                   indented_code(text_between(text, "\nRight:\n", "\n## "))});
  }
  return all;
}

std::string indented(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    out += "    " + std::string(text.substr(0, end)) + "\n";
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

}  // namespace

const std::vector<Explanation>& explanations() {
  static const std::vector<Explanation> kAll = explanations_in(kDiagnosticsText);
  return kAll;
}

const Explanation* find_explanation(std::string_view code) {
  const auto found = std::ranges::find(explanations(), code_of(code),
                                       [](const Explanation& e) { return std::optional(e.code); });
  return found == explanations().end() ? nullptr : &*found;
}

std::string page(const Explanation& e) {
  return to_string(e.code) + ": " + e.title + "\n\n" + wrapped(e.why, 80) + "\n\nWrong:\n\n" +
         indented(e.wrong) + "\nRight:\n\n" + indented(e.right);
}

std::string_view diagnostics_page() { return kDiagnosticsText; }

}  // namespace culprit
