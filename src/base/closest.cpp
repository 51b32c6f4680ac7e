#include "base/closest.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <numeric>

namespace culprit {
namespace {

// Damerau-Levenshtein with adjacent transpositions: a typo is mostly one slip of the fingers.
// Some number above `limit` if the distance is more than that.
std::size_t edit_distance(std::string_view a, std::string_view b, std::size_t limit) {
  std::vector<std::size_t> before(b.size() + 1), row(b.size() + 1), next(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    next[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitute = row[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      next[j] = std::min({substitute, row[j] + 1, next[j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) next[j] = std::min(next[j], before[j - 2] + 1);
    }
    before.swap(row);
    row.swap(next);
    // No later row is below both of the last two.
    const auto lowest = [](const auto& r) { return *std::min_element(r.begin(), r.end()); };
    if (lowest(row) > limit && lowest(before) > limit) return limit + 1;
  }
  return row[b.size()];
}

// A bit for each letter that occurs, other characters folded onto them.
std::uint64_t letters(std::string_view text) {
  std::uint64_t mask = 0;
  for (const char c : text) mask |= std::uint64_t{1} << (static_cast<unsigned char>(c) & 63);
  return mask;
}

// Below this no edit distance can be: each letter that only one of them has takes an edit.
std::size_t least_distance(std::string_view a, std::string_view b) {
  const std::uint64_t in_a = letters(a);
  const std::uint64_t in_b = letters(b);
  const auto unshared = std::max(std::popcount(in_a & ~in_b), std::popcount(in_b & ~in_a));
  const std::size_t longer = std::max(a.size(), b.size());
  return std::max(static_cast<std::size_t>(unshared), longer - std::min(a.size(), b.size()));
}

}  // namespace

std::string closest(std::string_view name, const std::vector<std::string_view>& known) {
  std::string_view best;
  std::size_t best_distance = std::numeric_limits<std::size_t>::max();
  for (const std::string_view candidate : known) {
    const std::size_t limit =
        std::min(std::max(name.size(), candidate.size()) / 3, best_distance - 1);
    if (least_distance(name, candidate) > limit) continue;
    const std::size_t distance = edit_distance(name, candidate, limit);
    if (distance > limit || distance == 0) continue;
    best = candidate;
    best_distance = distance;
    if (best_distance == 1) break;
  }
  return std::string(best);
}

}  // namespace culprit
