#include "language/diagnostic.h"

#include <algorithm>
#include <array>
#include <cstdio>

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

// Control characters would act on the terminal of whoever reads the message.
std::string printable(std::string_view text) {
  std::string out(text);
  std::replace_if(
      out.begin(), out.end(), [](unsigned char c) { return (c < 0x20 && c != '\t') || c == 0x7f; },
      '?');
  return out;
}

}  // namespace

std::string to_string(Code code) {
  char text[8];
  std::snprintf(text, sizeof text, "R%03u", static_cast<unsigned>(code));
  return text;
}

std::string title_of(const Edit& edit, const Source& source) {
  const std::string before = "'" + std::string(source.text(edit.span)) + "'";
  const std::string after = "'" + edit.text + "'";
  if (edit.span.begin == edit.span.end) return "insert " + after;
  return edit.text.empty() ? "remove " + before : "change " + before + " to " + after;
}

std::string render(const Diagnostic& diagnostic, const Source& source, Colour colour) {
  const Paint& paint = colour == Colour::kOn ? kColoured : kPlain;
  const bool is_error = diagnostic.severity == Severity::kError;
  const Position at = source.position(diagnostic.span.begin);
  const Span line = source.line(at.line);
  const Span marked{diagnostic.span.begin,
                    std::clamp(diagnostic.span.end, diagnostic.span.begin, line.end)};
  const std::string number = std::to_string(at.line);
  const std::string margin(std::max<std::size_t>(number.size(), 4), ' ');

  std::string out = source.name() + ":" + number + ":" + std::to_string(at.column) + ": ";
  out += std::string(is_error ? paint.error : paint.warning) + (is_error ? "error" : "warning") +
         "[" + to_string(diagnostic.code) + "]" + std::string(paint.off) + ": " +
         printable(diagnostic.cause) + "\n";
  out += std::string(paint.place) + margin.substr(number.size()) + number + " | " +
         std::string(paint.off) + printable(source.text(line)) + "\n";
  out += std::string(paint.place) + margin + " | " + std::string(paint.off) +
         blanks_like(source.text({line.begin, marked.begin})) +
         std::string(is_error ? paint.error : paint.warning) +
         std::string(std::max<std::size_t>(character_count(source.text(marked)), 1), '^') +
         std::string(paint.off) + "\n";
  if (!diagnostic.remedy.empty()) {
    out += std::string(paint.place) + margin + " = " + std::string(paint.off) +
           std::string(paint.remedy) + printable(diagnostic.remedy) + std::string(paint.off) + "\n";
  }
  return out;
}

std::optional<Edit> replacement(Span span, const std::string& near) {
  return near.empty() ? std::nullopt : std::optional(Edit{span, near});
}

}  // namespace culprit
