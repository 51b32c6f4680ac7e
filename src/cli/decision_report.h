// One decision from the journal, explained: who was suspected, what was weighed and why not, what
// was asked for, and what came of it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "journal/reader.h"

namespace culprit::cli {

// Row `id`, or the decision that it belongs to; the latest decision if `id` is 0. Errors: there is
// no such row, or the file cannot be read.
Expected<std::string> explain_decision(const journal::Reader& journal, std::int64_t id);
// The same as JSON: {"decision": row, "sequel": [rows]}, each as culprit log --json has it.
Expected<std::string> decision_as_json(const journal::Reader& journal, std::int64_t id);
// The row of the latest decision about a failure of one of these rules; 0: there is none.
Expected<std::int64_t> latest_decision_about(const std::vector<std::string>& rules,
                                             const journal::Reader& journal);

}  // namespace culprit::cli
