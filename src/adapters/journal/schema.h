// The tables of a journal file, and how a file of an older culprit is brought up to date.
#pragma once

#include "journal/database.h"

namespace culprit::journal {

// The schema of the files that this culprit writes.
int schema_version();

// Makes the tables in a new file, or brings an older one up to date, in one transaction. Errors:
// the file is of another program, or of a newer culprit; it is left as it was.
Expected<void> prepare_schema(Database& database);

// Whether this is a journal that this culprit can read, of its own version or of an older one.
Expected<void> check_schema(const Database& database);
// False for a journal of an older culprit, which has no such table or column.
bool has_latencies(const Database& database);
bool has_exposure(const Database& database);

// Whether it has the tables of a journal, but lacks the numbers in its head that mark it as one:
// not those of any culprit that there may be.
bool has_damaged_head(const Database& database);

}  // namespace culprit::journal
