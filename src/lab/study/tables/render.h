// The forms of a table. Each ends with a line end. The scripts in studies/ make HTML and LaTeX of
// the JSON.
#pragma once

#include <string>
#include <vector>

#include "study/tables/table.h"

namespace culprit::study {

// For a terminal. A sign behind the number replaces the colours: + better, ! worse.
std::string text(const Table& table);

// GitHub's. Significant changes are bold, with the same signs.
std::string markdown(const Table& table);

// An array of objects with the fields of a Table. Cells have "shade" ("not_significant", "better",
// "worse"), "strength" and "bold" only if they are set.
std::string tables_json(const std::vector<Table>& tables);

}  // namespace culprit::study
