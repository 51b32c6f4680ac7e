// The tables of beliefs, and the ends of the chain, as both readers and writers see them.
#pragma once

#include "journal/database.h"
#include "journal/entry.h"
#include "journal/learned.h"

namespace culprit::journal {

Expected<Learned> read_learned(const Database& database);

// A place in the chain: the row `id` and its hash. Zeros: before the first row.
struct Link {
  std::int64_t id = 0;
  Hash hash{};
};
Expected<Link> newest_link(const Database& database);
// The last row that was dropped for size or age.
Expected<Link> anchor(const Database& database);

std::optional<Hash> hash_from(std::string_view bytes);

}  // namespace culprit::journal
