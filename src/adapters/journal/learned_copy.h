// A second copy of what was learned, in a file of its own beside the journal: "a.journal-learned".
// It shows when the tables of the journal have changed, and what they were before; and, because it
// names a row that the journal had, when the end of the journal is lost. Coincidences, which make no
// rows, are in it as they were when it was written last.
#pragma once

#include <filesystem>
#include <optional>

#include "journal/tables.h"
#include "json/json.h"

namespace culprit::journal {

struct LearnedCopy {
  Link newest;  // the newest row of the journal when this was written
  Learned learned;
};

std::filesystem::path learned_beside(const std::filesystem::path& journal);

// On the disk when it returns.
Expected<void> write_copy(const std::filesystem::path& path, const LearnedCopy& copy);
// Nothing: there is no such file. Errors: it cannot be read, or is damaged.
Expected<std::optional<LearnedCopy>> read_copy(const std::filesystem::path& path);

// The bodies of rows that hold a new belief.
Json body_of(const LearnedBelief& learned);
Json body_of(const LearnedCoupling& learned);
Json body_of(const LearnedLatency& learned);

// The copy's content, with the newer rows of `journal` applied: its coincidences may be older.
Expected<Learned> brought_up_to_date(const LearnedCopy& copy, const Database& journal);

// Whether both hold the same, in whatever order. Coincidences do not count.
bool is_same(Learned a, Learned b);

}  // namespace culprit::journal
