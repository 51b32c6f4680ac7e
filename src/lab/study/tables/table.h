// A table of results before it is text, Markdown, LaTeX or HTML.
//
// Cells are plain UTF-8; each form escapes them as it needs. Beyond ASCII, all forms know only the
// signs that occur here: ± − – ✓ ✗ Δ.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace culprit::study {

enum class Align : std::uint8_t { kLeft, kCentre, kRight };

struct Column {
  std::string group = {};  // a common head of neighbours; empty: none
  std::string title = {};
  // The heads as LaTeX, where escaping the others is not enough.
  std::string group_latex = {};
  std::string title_latex = {};
  Align align = Align::kRight;
};

// The meaning of a cell's colour in the paper.
enum class Shade : std::uint8_t { kNone, kNotSignificant, kBetter, kWorse };

struct Cell {
  std::string text;
  Shade shade = Shade::kNone;
  double strength = 0;  // of kBetter and kWorse, in (0, 1]: the size of the effect
  bool is_bold = false;
};

struct Table {
  std::string id;  // for labels and anchors: letters, digits, dashes and underscores
  std::string caption;
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;  // as wide as the columns
  std::vector<std::string> notes;       // a sentence each, below the table
};

}  // namespace culprit::study
