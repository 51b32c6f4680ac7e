#include "study/tables/marks.h"
#include "study/tables/render.h"

namespace culprit::study {
namespace {

// Escapes the characters that Markdown or HTML would interpret.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\n') {
      out += ' ';
      continue;
    }
    if (std::string_view("\\`*_[]<>|~&").find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

std::string cell_text(const Cell& cell) {
  const std::string text = escaped(marked(cell));
  const bool is_significant = cell.shade == Shade::kBetter || cell.shade == Shade::kWorse;
  return cell.is_bold || is_significant ? "**" + text + "**" : text;
}

std::string_view rule(Align align) {
  switch (align) {
    case Align::kLeft:
      return ":--";
    case Align::kCentre:
      return ":-:";
    case Align::kRight:
      return "--:";
  }
  return "---";
}

}  // namespace

std::string markdown(const Table& table) {
  std::string out = "**" + escaped(table.caption) + "**\n\n|";
  for (const Column& column : table.columns) {
    const std::string group = column.group.empty() ? "" : escaped(column.group) + ": ";
    out += " " + group + escaped(column.title) + " |";
  }
  out += "\n|";
  for (const Column& column : table.columns)
    out.append(" ").append(rule(column.align)).append(" |");
  out += "\n";
  for (const auto& row : table.rows) {
    out += "|";
    for (const Cell& cell : row) out += " " + cell_text(cell) + " |";
    out += "\n";
  }
  const std::string marks = explanation_of_marks(table);
  if (!marks.empty()) out += "\n" + escaped(marks) + "\n";
  for (const std::string& note : table.notes) out += "\n" + escaped(note) + "\n";
  return out;
}

}  // namespace culprit::study
