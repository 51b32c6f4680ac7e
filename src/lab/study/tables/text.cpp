#include <algorithm>

#include "study/tables/marks.h"
#include "study/tables/render.h"

namespace culprit::study {
namespace {

constexpr std::string_view kGap = "  ";

// In columns of a terminal: one for each code point, which holds for all signs that occur.
std::size_t width(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0U) != 0x80;
  }));
}

std::string padded(const std::string& text, std::size_t to, Align align) {
  const std::size_t blanks = to - std::min(to, width(text));
  const std::size_t before = align == Align::kLeft    ? 0
                             : align == Align::kRight ? blanks
                                                      : blanks / 2;
  return std::string(before, ' ') + text + std::string(blanks - before, ' ');
}

std::vector<std::size_t> widths(const Table& table) {
  std::vector<std::size_t> widths;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    std::size_t widest = width(table.columns[i].title);
    for (const auto& row : table.rows) widest = std::max(widest, width(marked(row[i])));
    widths.push_back(widest);
  }
  // A group's head may need more than its columns; the last of them gets it.
  for (const HeadSpan& span : head_spans(table)) {
    std::size_t have = (span.end - span.begin - 1) * kGap.size();
    for (std::size_t i = span.begin; i < span.end; ++i) have += widths[i];
    const std::size_t need = width(table.columns[span.begin].group);
    if (need > have) widths[span.end - 1] += need - have;
  }
  return widths;
}

std::string without_trailing_blanks(std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

std::string group_line(const Table& table, const std::vector<std::size_t>& widths) {
  std::string line;
  for (const HeadSpan& span : head_spans(table)) {
    std::size_t room = (span.end - span.begin - 1) * kGap.size();
    for (std::size_t i = span.begin; i < span.end; ++i) room += widths[i];
    line += padded(table.columns[span.begin].group, room, Align::kCentre);
    line += kGap;
  }
  return without_trailing_blanks(line);
}

}  // namespace

std::string text(const Table& table) {
  const std::vector<std::size_t> column_widths = widths(table);
  std::string out = table.caption + "\n\n";
  if (has_groups(table)) out += group_line(table, column_widths);
  const auto line = [&](const auto& text_of) {
    std::string words;
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      words += padded(text_of(i), column_widths[i], table.columns[i].align);
      words += kGap;
    }
    out += without_trailing_blanks(words);
  };
  line([&](std::size_t i) { return table.columns[i].title; });
  line([&](std::size_t i) { return std::string(column_widths[i], '-'); });
  for (const auto& row : table.rows) line([&](std::size_t i) { return marked(row[i]); });
  const std::string marks = explanation_of_marks(table);
  if (!marks.empty()) out += "\n" + marks + "\n";
  for (const std::string& note : table.notes) out += "\n" + note + "\n";
  return out;
}

}  // namespace culprit::study
