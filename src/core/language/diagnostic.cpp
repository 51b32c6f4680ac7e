#include "language/diagnostic.h"

#include <algorithm>
#include <cstdio>

#include "base/name_grammar.h"
#include "base/utf8.h"

namespace culprit {
namespace {

struct Paint {
  std::string_view error, warning, place, remedy, off;
};
constexpr Paint kPlain{};
constexpr Paint kColoured{"\033[1;31m", "\033[1;33m", "\033[1;34m", "\033[1;32m", "\033[0m"};

// Tabs in the shown line stay tabs under it, so that the carets line up on every terminal.
std::string blanks_like(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if ((static_cast<unsigned char>(c) & 0xC0) != 0x80) out += c == '\t' ? '\t' : ' ';
  }
  return out;
}

// Characters that act on the reader's terminal are replaced, each by one that is as wide.
std::string without_controls(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::string_view next = text.substr(0, std::max<std::size_t>(character_length(text), 1));
    out += next == "\t" || escape_controls(next) == next ? next : "?";
    text.remove_prefix(next.size());
  }
  return out;
}

}  // namespace

std::string to_string(Code code) {
  char text[8];
  std::snprintf(text, sizeof text, "R%03u", static_cast<unsigned>(code));
  return text;
}

std::string title_of(const Edit& edit, const Source& source) {
  const std::string before = "'" + without_controls(source.text(edit.span)) + "'";
  const std::string after = "'" + without_controls(edit.text) + "'";
  if (edit.span.begin == edit.span.end) return "insert " + after;
  return edit.text.empty() ? "remove " + before : "change " + before + " to " + after;
}

LocatedDiagnostic located(const Diagnostic& diagnostic, const Source& source) {
  const Origin origin = source.origin(diagnostic.span);
  LocatedDiagnostic out{origin.place, {}, {}};
  if (origin.goes_in) out.notes.push_back({*origin.goes_in, "it goes in here"});
  for (const Step& step : origin.steps) {
    const bool is_use = step.kind == Step::Kind::kUse;
    out.notes.push_back({step.statement, is_use ? "used here" : "included here"});
  }
  if (!diagnostic.fix) return out;
  const Origin edited = source.origin(diagnostic.fix->span);
  if (edited.is_exact && edited.place.file == origin.place.file)
    out.fix = Edit{edited.place.span, diagnostic.fix->text};
  return out;
}

std::vector<Diagnostic> as_written(std::vector<Diagnostic> diagnostics, const Source& source) {
  for (Diagnostic& d : diagnostics) {
    LocatedDiagnostic here = located(d, source);
    d.span = here.place.span;
    d.fix = std::move(here.fix);
  }
  return diagnostics;
}

namespace {

// Where `text` has its character number `count`; its end if it has fewer.
std::size_t offset_of_character(std::string_view text, std::size_t count) {
  std::size_t at = 0;
  for (; at < text.size(); ++at) {
    const bool begins = (static_cast<unsigned char>(text[at]) & 0xC0) != 0x80;
    if (begins && count-- == 0) break;
  }
  return at;
}

// The part of a long line around the mistake, so that it fits on a screen.
struct Excerpt {
  Span shown;   // of the source
  Span marked;  // in it
  bool is_cut_before = false, is_cut_behind = false;
};

constexpr std::size_t kWidth = 120;  // characters; lines that are not longer are shown whole
constexpr std::size_t kBefore = 40;  // of a longer one, in front of the mistake

Excerpt excerpt(const Source& source, Span line, Span marked) {
  if (line.end - line.begin <= kWidth || character_count(source.text(line)) <= kWidth)
    return {line, marked};
  Excerpt out{line, marked};
  const std::string_view text = source.text(line);
  const std::size_t first = character_count(text.substr(0, marked.begin - line.begin));
  if (first > kBefore) {
    out.is_cut_before = true;
    out.shown.begin += static_cast<std::uint32_t>(offset_of_character(text, first - kBefore));
  }
  const std::string_view rest = source.text(out.shown);
  const std::size_t length = offset_of_character(rest, kWidth);
  out.is_cut_behind = length < rest.size();
  out.shown.end = out.shown.begin + static_cast<std::uint32_t>(length);
  out.marked.end = std::clamp(marked.end, marked.begin, std::max(marked.begin, out.shown.end));
  return out;
}

// "file:3:5: what", the line with carets under the span, and the remedy, if there is one.
std::string shown(const Source& source, Span span, const std::string& what, std::string_view mark,
                  std::string_view remedy, const Paint& paint) {
  const Position at = source.position(span.begin);
  const Span line = source.line(at.line);
  const auto [part, marked, is_cut_before, is_cut_behind] = excerpt(
      source, line, {span.begin, std::clamp(span.end, span.begin, std::max(span.begin, line.end))});
  const std::string_view before = is_cut_before ? "... " : "";
  const std::string number = std::to_string(at.line);
  const std::string margin(std::max<std::size_t>(number.size(), 4), ' ');
  std::string out = without_controls(source.name()) + ":" + number + ":" +
                    std::to_string(at.column) + ": " + what;
  out += "\n";
  const bool is_text = source.text(line).find('\0') == std::string_view::npos;
  if (is_text) {
    out += std::string(paint.place) + margin.substr(number.size()) + number + " | " +
           std::string(paint.off) + std::string(before) + without_controls(source.text(part)) +
           (is_cut_behind ? " ..." : "") + "\n";
    out += std::string(paint.place) + margin + " | " + std::string(paint.off) +
           blanks_like(before) + blanks_like(source.text({part.begin, marked.begin})) +
           std::string(mark) +
           std::string(std::max<std::size_t>(character_count(source.text(marked)), 1), '^') +
           std::string(paint.off) + "\n";
  }
  if (remedy.empty()) return out;
  return out + std::string(paint.place) + margin + " = " + std::string(paint.off) +
         std::string(paint.remedy) + without_controls(remedy) + std::string(paint.off) + "\n";
}

}  // namespace

std::string render(const Diagnostic& diagnostic, const Source& source, Colour colour) {
  const Paint& paint = colour == Colour::kOn ? kColoured : kPlain;
  const bool is_error = diagnostic.severity == Severity::kError;
  const std::string_view mark = is_error ? paint.error : paint.warning;
  const LocatedDiagnostic here = located(diagnostic, source);
  const std::string what = std::string(mark) + (is_error ? "error" : "warning") + "[" +
                           to_string(diagnostic.code) + "]" + std::string(paint.off) + ": " +
                           without_controls(diagnostic.cause);
  std::string out =
      shown(source.file(here.place.file), here.place.span, what, mark, diagnostic.remedy, paint);
  for (const auto& note : here.notes)
    out += shown(source.file(note.place.file), note.place.span, "note: " + note.text, paint.place,
                 "", paint);
  return out;
}

std::string render(const std::vector<Diagnostic>& diagnostics, const Source& source,
                   Colour colour) {
  const auto is_error = [](const Diagnostic& d) { return d.severity == Severity::kError; };
  const auto errors =
      static_cast<std::size_t>(std::count_if(diagnostics.begin(), diagnostics.end(), is_error));
  const std::size_t warnings = diagnostics.size() - errors;
  std::size_t errors_left = std::min(errors, kMostShown);
  std::size_t warnings_left = std::min(warnings, kMostShown - errors_left);
  const auto count = [](std::size_t n, const char* what) {
    return std::to_string(n) + " more " + what + (n == 1 ? "" : "s");
  };
  std::string more;
  if (errors > errors_left) more = count(errors - errors_left, "error");
  if (warnings > warnings_left)
    more += (more.empty() ? "" : " and ") + count(warnings - warnings_left, "warning");
  std::string out;
  for (const Diagnostic& d : diagnostics) {
    std::size_t& left = is_error(d) ? errors_left : warnings_left;
    if (left == 0) continue;
    --left;
    out += render(d, source, colour);
  }
  return more.empty() ? out : out + source.name() + ": " + more + " not shown\n";
}

std::optional<Edit> replacement(Span span, const std::string& near) {
  return near.empty() ? std::nullopt : std::optional(Edit{span, near});
}

}  // namespace culprit
