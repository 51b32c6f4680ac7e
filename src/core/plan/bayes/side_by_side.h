// Strategies that begin together take only as long as the longest.
//
// The set of the highest worth (conflict_free_set.h) counts the time of each of its strategies,
// though the robot waits only for the longest. So the strategy that each of its failures begins
// with is chosen once more, for all of them together, assuming further rounds as long as they fail:
//
//     E = sum_r ( sum_i p_i,r (c_i,r - t_i,r) + T_r )
//
//   c_i,r, t_i,r   what the r-th try for failure i costs, and the part of it that its time is
//   p_i,r          the probability that failure i is still there then: a(T) of value.h, with T what
//                  was tried for it before
//   T_r            the expected longest t_i,r among the failures that are still there: with the
//                  failures in the order of t, longest first,
//                  sum_i t_i,r p_i,r prod_{k before i} (1 - p_k,r)
//
// A single failure has its cheapest order anyway (value.h). Two components that would each be
// restarted first may both be replaced at once instead: then neither waits for the other one's
// replacement.
#pragma once

#include <vector>

#include "plan/bayes/value.h"

namespace culprit::plan {

// A failure that is to be repaired.
struct Side {
  std::vector<Try> tries;           // all that is left, in the order of u/c
  std::vector<std::size_t> firsts;  // of these, what it may begin with; the usual one first
};

// E, if each side begins with this one of its tries.
double joint_cost(std::span<const Side> sides, std::span<const std::size_t> begins);

// For each side the one of its firsts with which E is lowest. Among equals the usual ones. Exact
// while there are few; beyond, no change at one side alone makes it better.
std::vector<std::size_t> side_by_side(std::span<const Side> sides);

}  // namespace culprit::plan
