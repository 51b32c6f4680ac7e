#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "study/tables/marks.h"
#include "study/tables/render.h"

namespace culprit::study {
namespace {

constexpr std::array<std::pair<std::string_view, std::string_view>, 19> kSpelled = {{
    {"\\", "\\textbackslash{}"},
    {"{", "\\{"},
    {"}", "\\}"},
    {"%", "\\%"},
    {"&", "\\&"},
    {"#", "\\#"},
    {"$", "\\$"},
    {"_", "\\_"},
    {"^", "\\^{}"},
    {"~", "\\~{}"},
    {"±", "$\\pm$"},
    {"−", "$-$"},
    {"–", "\\textendash{}"},  // dashes in a row would become another sign
    {"<", "$<$"},
    {">", "$>$"},
    {"|", "$|$"},
    {"✓", "\\checkmark"},
    {"✗", "$\\times$"},
    {"Δ", "$\\Delta$"},
}};

std::string escaped(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const auto spelled = std::find_if(kSpelled.begin(), kSpelled.end(), [text](const auto& entry) {
      return text.starts_with(entry.first);
    });
    if (spelled == kSpelled.end()) {
      out += text.front();
      text.remove_prefix(1);
    } else {
      out += spelled->second;
      text.remove_prefix(spelled->first.size());
    }
  }
  return out;
}

std::string head(const std::string& latex, const std::string& plain) {
  return latex.empty() ? escaped(plain) : latex;
}

// As the paper: grey for what is not significant, else the stronger the larger.
std::string colour(const Cell& cell) {
  const int percent = std::clamp(static_cast<int>(std::lround(cell.strength * 100)), 1, 100);
  switch (cell.shade) {
    case Shade::kNone:
      return "";
    case Shade::kNotSignificant:
      return "\\cellcolor{gray!25}";
    case Shade::kBetter:
      return fmt::format("\\cellcolor{{green!{}}}", percent);
    case Shade::kWorse:
      return fmt::format("\\cellcolor{{red!{}}}", percent);
  }
  return "";
}

std::string cell_text(const Cell& cell) {
  const std::string text = escaped(cell.text);
  return colour(cell) + (cell.is_bold ? "\\textbf{" + text + "}" : text);
}

char letter(Align align) {
  return align == Align::kLeft ? 'l' : align == Align::kCentre ? 'c' : 'r';
}

std::string group_heads(const Table& table) {
  std::string heads;
  std::string rules;
  for (const HeadSpan& span : head_spans(table)) {
    if (span.begin > 0) heads += " & ";
    const Column& first = table.columns[span.begin];
    if (first.group.empty()) continue;
    heads += fmt::format("\\multicolumn{{{}}}{{c}}{{{}}}", span.end - span.begin,
                         head(first.group_latex, first.group));
    rules += fmt::format("\\cmidrule(lr){{{}-{}}}", span.begin + 1, span.end);
  }
  return heads + " \\\\\n" + rules + "\n";
}

}  // namespace

std::string latex(const Table& table) {
  std::string letters;
  std::string titles;
  for (const Column& column : table.columns) {
    letters += letter(column.align);
    if (!titles.empty()) titles += " & ";
    titles += head(column.title_latex, column.title);
  }
  std::string out =
      "% needs \\usepackage{amsmath,amssymb,booktabs} and \\usepackage[table]{xcolor}\n";
  out += "\\begin{table}[ht]\n\\centering\n\\caption{" + escaped(table.caption) + "}\n";
  out += "\\label{tab:" + table.id + "}\n\\begin{tabular}{" + letters + "}\n\\toprule\n";
  if (has_groups(table)) out += group_heads(table);
  out += titles + " \\\\\n\\midrule\n";
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) out += (i > 0 ? " & " : "") + cell_text(row[i]);
    out += " \\\\\n";
  }
  out += "\\bottomrule\n\\end{tabular}\n";
  for (const std::string& note : table.notes)
    out += "\n\\smallskip\n{\\footnotesize " + escaped(note) + "}\n";
  return out + "\\end{table}\n";
}

}  // namespace culprit::study
