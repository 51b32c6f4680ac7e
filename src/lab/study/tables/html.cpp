#include <fmt/core.h>

#include "study/markup.h"
#include "study/tables/marks.h"
#include "study/tables/render.h"

namespace culprit::study {
namespace {

std::string_view shade_class(Shade shade) {
  switch (shade) {
    case Shade::kNone:
      return "";
    case Shade::kNotSignificant:
      return " grey";
    case Shade::kBetter:
      return " better";
    case Shade::kWorse:
      return " worse";
  }
  return "";
}

// For screen readers, and for readers without colours.
std::string_view spoken(Shade shade) {
  switch (shade) {
    case Shade::kNone:
      return "";
    case Shade::kNotSignificant:
      return "<span class=\"mark\"></span>";  // so that numbers stay below one another
    case Shade::kBetter:
      return "<span class=\"mark\" title=\"significantly better\" "
             "aria-label=\"significantly better\">+</span>";
    case Shade::kWorse:
      return "<span class=\"mark\" title=\"significantly worse\" "
             "aria-label=\"significantly worse\">!</span>";
  }
  return "";
}

std::string_view align_class(Align align) {
  return align == Align::kLeft ? "left" : align == Align::kCentre ? "centre" : "right";
}

std::string group_head(const Table& table) {
  std::string out = "<tr>";
  for (const HeadSpan& span : head_spans(table)) {
    const std::string& group = table.columns[span.begin].group;
    out += group.empty()
               ? "<td></td>"
               : fmt::format("<th class=\"group\" colspan=\"{}\" scope=\"colgroup\">{}</th>",
                             span.end - span.begin, markup_escaped(group));
  }
  return out + "</tr>\n";
}

std::string cell_html(const Cell& cell, const Column& column) {
  std::string style;
  if (cell.strength > 0) style = fmt::format(" style=\"--strength:{:.2f}\"", cell.strength);
  const std::string text = markup_escaped(cell.text);
  return fmt::format("<td class=\"{}{}\"{}>{}{}</td>", align_class(column.align),
                     shade_class(cell.shade), style,
                     cell.is_bold ? "<strong>" + text + "</strong>" : text, spoken(cell.shade));
}

}  // namespace

std::string html(const Table& table) {
  std::string out = fmt::format(
      "<figure class=\"table\" id=\"{}\">\n<div class=\"wide\" tabindex=\"0\" role=\"region\" "
      "aria-labelledby=\"{}-caption\"><table>\n<caption id=\"{}-caption\">{}</caption>\n<thead>\n",
      table.id, table.id, table.id, markup_escaped(table.caption));
  if (has_groups(table)) out += group_head(table);
  out += "<tr>";
  for (const Column& column : table.columns) {
    out += fmt::format("<th scope=\"col\" class=\"{}\">{}</th>", align_class(column.align),
                       markup_escaped(column.title));
  }
  out += "</tr>\n</thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    out += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) out += cell_html(row[i], table.columns[i]);
    out += "</tr>\n";
  }
  out += "</tbody>\n</table></div>\n";
  if (has_shades(table))
    out +=
        "<p class=\"legend\"><span class=\"swatch better\"></span> significantly better "
        "<span class=\"swatch worse\"></span> significantly worse "
        "<span class=\"swatch grey\"></span> not significant</p>\n";
  for (const std::string& note : table.notes)
    out += "<p class=\"note\">" + markup_escaped(note) + "</p>\n";
  return out + "</figure>\n";
}

}  // namespace culprit::study
