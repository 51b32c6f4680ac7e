#include "language/foreign_files.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string>
#include <string_view>

#include "language/reserved_words.h"
#include "language/scanner.h"

namespace culprit {
namespace {

constexpr std::string_view kDraft =
    "a rule file is plain text; culprit init -o my.rules drafts one from the robot";

constexpr std::string_view kTest = "a test of rules";
constexpr std::string_view kConfiguration = "a configuration of culprit run";

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

// "rules = "my.rules"", which a configuration has beside other options.
bool names_rules(std::string_view line) {
  constexpr std::string_view kKey = "rules";
  return line.starts_with(kKey) && trimmed(line.substr(kKey.size())).starts_with("= \"");
}

bool is_of_python(std::string_view line) {
  return line.starts_with("import ") || line.starts_with("def ") || line.starts_with("class ") ||
         (line.starts_with("from ") && line.find(" import ") != std::string_view::npos);
}

// The other language; empty: none is known.
std::string_view language_of(const Source& source) {
  if (source.text().find('\0') != std::string_view::npos) return "binary";
  const auto lines = statement_lines(source);
  if (lines.empty()) return "";
  if (lines.front().starts_with("RULES ")) return kTest;
  if (std::any_of(lines.begin(), lines.end(), is_of_rules)) return "";
  if (source.text().starts_with("#!")) return "a script";
  if (std::any_of(lines.begin(), lines.end(), names_rules)) return kConfiguration;
  const std::string_view first = lines.front();
  const bool is_word_in_brackets = first.size() > 1 && first[0] == '[' &&
                                   std::isalpha(static_cast<unsigned char>(first[1])) != 0;
  if (is_word_in_brackets) return "INI or TOML";
  if (first.starts_with("{%") || first.starts_with("{{")) return "a template of another tool";
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
  const std::string remedy(
      language == "JSON"  ? "culprit import reads the JSON that culprit export --json wrote"
      : language == kTest ? "culprit test runs it"
      : language == kConfiguration ? "culprit run --config " + source.name() + " reads it"
                                   : std::string(kDraft));
  return Diagnostic{Code::kBadToken,
                    Severity::kError,
                    {begin, begin + 1},
                    "this file is " + std::string(language) + ", not a rule file",
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
    if (close == std::string_view::npos) return;
    const auto end = static_cast<std::uint32_t>(close) + 2;
    diagnostics[i].fix = as_comment(text, {begin, end});
    std::erase_if(diagnostics,
                  [&](const Diagnostic& d) { return d.span.begin > begin && d.span.begin < end; });
  }
}

// A merge that was not finished: its marks are in the text, and both sides.
std::optional<Diagnostic> open_merge(const Source& source) {
  for (std::uint32_t number = 1; number <= source.line_count(); ++number) {
    const Span line = source.line(number);
    if (source.text(line).starts_with("<<<<<<< "))
      return Diagnostic{Code::kBadToken, Severity::kError, line, "a merge was not finished here",
                        "keep one of the two sides, and remove the three marks"};
  }
  return std::nullopt;
}

// A text without a single statement: that it is another file says more than each of its lines.
std::optional<Diagnostic> other_text(const Source& source, const std::vector<Diagnostic>& all) {
  const auto lines = statement_lines(source);
  const bool is_any = std::ranges::any_of(lines, [](std::string_view line) {
    const std::string_view word = line.substr(0, line.find_first_of(" \t(:"));
    const auto words = reserved_words();
    return std::ranges::find(words, word) != words.end() || word == "THEN" || word == "INCLUDE" ||
           word == "USE" || word == "TEMPLATE" || word == "END";
  });
  const bool are_unknown = std::ranges::all_of(all, [](const Diagnostic& d) {
    const auto words = reserved_words();
    const bool is_typo = d.fix && std::ranges::find(words, d.fix->text) != words.end();
    return !is_typo && (d.code == Code::kUnknownStatement || d.code == Code::kBadToken);
  });
  if (is_any || !are_unknown || lines.size() < 2 || all.size() < 2) return std::nullopt;
  return Diagnostic{Code::kBadToken, Severity::kError, all.front().span,
                    "no line of this file is a statement of the rule language",
                    std::string(kDraft)};
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
  auto whole = is_utf16 ? std::nullopt : open_merge(source);
  if (!whole && !is_utf16) whole = other_text(source, diagnostics);
  if (whole) {
    diagnostics = {std::move(*whole)};
    return;
  }
  condense_comments(source, diagnostics);
  condense_braces(source, diagnostics);
}

}  // namespace culprit
