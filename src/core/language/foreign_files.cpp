#include "language/foreign_files.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string>
#include <string_view>

#include "language/scanner.h"

namespace culprit {
namespace {

constexpr std::string_view kDraft =
    "a rule file is plain text; culprit init -o my.rules drafts one from the robot";

// The lines that have something else than a comment.
std::vector<std::string_view> statement_lines(const Source& source) {
  constexpr std::size_t kEnough = 100;
  std::vector<std::string_view> lines;
  for (std::uint32_t number = 1; number <= source.line_count() && lines.size() < kEnough;
       ++number) {
    const std::string_view line = trimmed(source.text(source.line(number)));
    if (!line.empty() && !line.starts_with('#') && !line.starts_with("//")) lines.push_back(line);
  }
  return lines;
}

bool is_of_rules(std::string_view line) {
  return line.starts_with("RULE ") || line.starts_with("COMPONENT ") || line.starts_with("CONST ");
}

// "name:", "- name: value", "name: value"
bool is_of_yaml(std::string_view line) {
  if (line == "---") return true;
  if (line.starts_with("- ")) line = trimmed(line.substr(2));
  const auto colon = line.find(':');
  if (colon == std::string_view::npos || colon == 0) return false;
  if (colon + 1 < line.size() && line[colon + 1] != ' ') return false;
  return std::all_of(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(colon),
                     [](unsigned char c) {
                       return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '_' || c == '-';
                     });
}

bool is_of_python(std::string_view line) {
  return line.starts_with("import ") ||
         (line.starts_with("from ") && line.find(" import ") != std::string_view::npos);
}

// The other language; empty: none is known.
std::string_view language_of(const Source& source) {
  if (source.text().find('\0') != std::string_view::npos) return "binary";
  const auto lines = statement_lines(source);
  if (lines.empty() || std::any_of(lines.begin(), lines.end(), is_of_rules)) return "";
  const std::string_view first = lines.front();
  if (first.starts_with('{') || first.starts_with('[')) return "JSON";
  const bool is_tag = first.starts_with('<') && first.size() > 1 &&
                      (std::isalpha(static_cast<unsigned char>(first[1])) != 0 || first[1] == '?' ||
                       first[1] == '!');
  if (is_tag) return "XML";
  if (is_of_python(first)) return "Python";
  const auto of_yaml = std::count_if(lines.begin(), lines.end(), is_of_yaml);
  return is_of_yaml(first) && of_yaml > 1 && 2 * of_yaml >= std::ssize(lines) ? "YAML" : "";
}

std::optional<Diagnostic> foreign_language(const Source& source) {
  const std::string_view language = language_of(source);
  if (language.empty()) return std::nullopt;
  const auto begin = static_cast<std::uint32_t>(
      language == "binary" ? 0 : statement_lines(source).front().data() - source.text().data());
  const std::string remedy = language == "JSON"
                                 ? "culprit import reads the JSON that culprit export --json wrote"
                                 : std::string(kDraft);
  return Diagnostic{Code::kBadToken,
                    Severity::kError,
                    {begin, begin + 1},
                    "this file is " + std::string(language) + ", and no rule file",
                    remedy};
}

bool is_about(const Diagnostic& d, const Source& source, Code code, std::string_view written) {
  return d.code == code && source.text(d.span) == written;
}

// The comment as one of the language.
Edit as_comment(std::string_view text, Span whole) {
  std::string out = "#";
  for (std::size_t i = whole.begin + 2; i < whole.end; ++i) {
    if (text.substr(i, 2) == "*/") {
      ++i;
      continue;
    }
    out += text[i];
    if (text[i] == '\n') out += '#';
  }
  return {whole, out};
}

// "/* ... */" over several lines: its lines are read as statements.
void condense_comments(const Source& source, std::vector<Diagnostic>& diagnostics) {
  const std::string_view text = source.text();
  for (std::size_t i = 0; i < diagnostics.size(); ++i) {
    if (!is_about(diagnostics[i], source, Code::kUnknownStatement, "/*")) continue;
    const std::uint32_t begin = diagnostics[i].span.begin;
    const auto close = text.find("*/", begin + 2);
    if (close == std::string_view::npos) continue;
    const auto end = static_cast<std::uint32_t>(close) + 2;
    diagnostics[i].fix = as_comment(text, {begin, end});
    std::erase_if(diagnostics,
                  [&](const Diagnostic& d) { return d.span.begin > begin && d.span.begin < end; });
  }
}

// The '}' of a '{' that was reported.
void condense_braces(const Source& source, std::vector<Diagnostic>& diagnostics) {
  const auto is_open = [&](const Diagnostic& d) {
    return is_about(d, source, Code::kBadToken, "{");
  };
  if (std::none_of(diagnostics.begin(), diagnostics.end(), is_open)) return;
  std::erase_if(diagnostics,
                [&](const Diagnostic& d) { return is_about(d, source, Code::kBadToken, "}"); });
}

}  // namespace

void condense(const Source& source, std::vector<Diagnostic>& diagnostics) {
  const bool has_error = std::any_of(diagnostics.begin(), diagnostics.end(),
                                     [](const auto& d) { return d.severity == Severity::kError; });
  if (!has_error) return;
  const bool is_utf16 =  // which was reported
      source.text().starts_with("\xff\xfe") || source.text().starts_with("\xfe\xff");
  if (auto foreign = foreign_language(source); foreign && !is_utf16) {
    diagnostics = {std::move(*foreign)};
    return;
  }
  condense_comments(source, diagnostics);
  condense_braces(source, diagnostics);
}

}  // namespace culprit
