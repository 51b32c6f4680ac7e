// Do two lists of numbers put the same things in the same order?
//
//     Spearman's rho: Pearson's correlation of the ranks, ties with their mean rank
//     Kendall's tau-b: (concordant - discordant pairs) / sqrt((pairs - ties in a) (pairs - ties in
//     b))
//
// Both are 1 for the same order and -1 for the opposite one.
#pragma once

#include <optional>
#include <span>

namespace culprit::study {

// Empty if there are fewer than two, or if one list has the same number everywhere. @pre as many of
// either
std::optional<double> spearman_rho(std::span<const double> a, std::span<const double> b);
std::optional<double> kendall_tau(std::span<const double> a, std::span<const double> b);

// The share of all orders of `b` whose |rho| is at least as large as that of `a` and `b`: the exact
// two-sided p of no relation. Empty as rho is, and for more than nine. @pre as many of either
std::optional<double> spearman_p(std::span<const double> a, std::span<const double> b);

}  // namespace culprit::study
