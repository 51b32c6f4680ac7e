// Which together? The items of the highest total worth of which no two conflict.
//
// Two items conflict if they are for the same failure, or if one takes something near to what the
// other takes. Exact up to kExact items, by branch and bound over the failures: a branch is left
// when even the best remaining item of every remaining failure could not make it better. Beyond,
// greedy by worth, and then improved by swaps: an item gives way to those that it alone excludes,
// if they are worth more together.
#pragma once

#include <vector>

#include "diagnose/bit_rows.h"

namespace culprit::plan {

using diagnose::BitRows;
using diagnose::Word;

inline constexpr std::size_t kExact = 20;

struct Item {
  std::size_t failure = 0;
  std::int64_t worth = 0;       // > 0, in parts of any unit: sums are exact
  std::span<const Word> takes;  // places
  std::span<const Word> near;   // places where no other may be taken; includes `takes`. Mutual: a
                                // takes near b if and only if b takes near a.
};

bool conflict(const Item& a, const Item& b);

// Indices into `items`, ascending. Among sets of the same worth, the one with earlier items.
std::vector<std::size_t> best_conflict_free_set(std::span<const Item> items);

// The two ways; for tests and measurements.
std::vector<std::size_t> exact_set(std::span<const Item> items);
std::vector<std::size_t> greedy_set(std::span<const Item> items);

}  // namespace culprit::plan
