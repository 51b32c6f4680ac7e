#include "study/tables/marks.h"

#include <algorithm>

namespace culprit::study {

std::string marked(const Cell& cell) {
  if (cell.shade == Shade::kBetter) return cell.text + " +";
  if (cell.shade == Shade::kWorse) return cell.text + " !";
  return cell.text;
}

bool has_shades(const Table& table) {
  return std::any_of(table.rows.begin(), table.rows.end(), [](const std::vector<Cell>& row) {
    return std::any_of(row.begin(), row.end(),
                       [](const Cell& cell) { return cell.shade != Shade::kNone; });
  });
}

std::string explanation_of_marks(const Table& table) {
  if (!has_shades(table)) return "";
  return "+ significantly better, ! significantly worse; without a sign not significant.";
}

bool has_groups(const Table& table) {
  return std::any_of(table.columns.begin(), table.columns.end(),
                     [](const Column& column) { return !column.group.empty(); });
}

std::vector<HeadSpan> head_spans(const Table& table) {
  std::vector<HeadSpan> spans;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const std::string& group = table.columns[i].group;
    const bool continues = i > 0 && !group.empty() && table.columns[i - 1].group == group;
    if (continues) {
      spans.back().end = i + 1;
    } else {
      spans.push_back({i, i + 1});
    }
  }
  return spans;
}

}  // namespace culprit::study
