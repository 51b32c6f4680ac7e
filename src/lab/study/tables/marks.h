// The signs for a cell's shade in forms without colour.
#pragma once

#include <string>

#include "study/tables/table.h"

namespace culprit::study {

// The text with " +" behind it for better, " !" for worse.
std::string marked(const Cell& cell);

// A sentence that explains the signs if the table has shades; empty if not.
std::string explanation_of_marks(const Table& table);

bool has_shades(const Table& table);
bool has_groups(const Table& table);

// Neighbouring columns of one group, or one column without: [begin, end).
struct HeadSpan {
  std::size_t begin = 0;
  std::size_t end = 0;
};
std::vector<HeadSpan> head_spans(const Table& table);

}  // namespace culprit::study
