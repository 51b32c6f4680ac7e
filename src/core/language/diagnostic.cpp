#include "language/diagnostic.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <numeric>

namespace culprit {
namespace {

// Damerau-Levenshtein with adjacent transpositions: a typo is mostly one slip of the fingers.
// Some number above `limit` if the distance is more than that.
std::size_t edit_distance(std::string_view a, std::string_view b, std::size_t limit) {
  std::vector<std::size_t> before(b.size() + 1), row(b.size() + 1), next(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    next[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitute = row[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      next[j] = std::min({substitute, row[j] + 1, next[j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) next[j] = std::min(next[j], before[j - 2] + 1);
    }
    before.swap(row);
    row.swap(next);
    // No later row is below both of the last two.
    const auto lowest = [](const auto& r) { return *std::min_element(r.begin(), r.end()); };
    if (lowest(row) > limit && lowest(before) > limit) return limit + 1;
  }
  return row[b.size()];
}

// A bit for each letter that occurs, other characters folded onto them.
std::uint64_t letters(std::string_view text) {
  std::uint64_t mask = 0;
  for (const char c : text) mask |= std::uint64_t{1} << (static_cast<unsigned char>(c) & 63);
  return mask;
}

// Below this no edit distance can be: each letter that only one of them has takes an edit.
std::size_t least_distance(std::string_view a, std::string_view b) {
  const std::uint64_t in_a = letters(a);
  const std::uint64_t in_b = letters(b);
  const auto unshared = std::max(std::popcount(in_a & ~in_b), std::popcount(in_b & ~in_a));
  const std::size_t longer = std::max(a.size(), b.size());
  return std::max(static_cast<std::size_t>(unshared), longer - std::min(a.size(), b.size()));
}

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

std::string closest(std::string_view name, const std::vector<std::string_view>& known) {
  std::string_view best;
  std::size_t best_distance = std::numeric_limits<std::size_t>::max();
  for (const std::string_view candidate : known) {
    const std::size_t limit =
        std::min(std::max(name.size(), candidate.size()) / 3, best_distance - 1);
    if (least_distance(name, candidate) > limit) continue;
    const std::size_t distance = edit_distance(name, candidate, limit);
    if (distance > limit || distance == 0) continue;
    best = candidate;
    best_distance = distance;
    if (best_distance == 1) break;
  }
  return std::string(best);
}

std::optional<Edit> replacement(Span span, const std::string& near) {
  return near.empty() ? std::nullopt : std::optional(Edit{span, near});
}

}  // namespace culprit
