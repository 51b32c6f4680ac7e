// The forms of a table. Each ends with a line end.
#pragma once

#include <string>

#include "study/tables/table.h"

namespace culprit::study {

// For a terminal. A sign behind the number replaces the colours: + better, ! worse.
std::string text(const Table& table);

// GitHub's. Significant changes are bold, with the same signs.
std::string markdown(const Table& table);

// A table environment like the paper's, with booktabs and xcolor's [table] option.
std::string latex(const Table& table);

// A <figure> with a <table>; classes "better", "worse" and "grey" name the shades, the custom
// property --strength their size. Self-contained but for its style (study/report/report.css).
std::string html(const Table& table);

}  // namespace culprit::study
