// What begins together passes together.
//
// The set of the highest worth (conflict_free_set.h) counts the time of each of its strategies,
// though the robot waits only for the longest. So with which strategy each of its failures is begun
// is weighed once more, for all of them together, going on in rounds as long as they fail:
//
//     E = sum_r ( sum_i p_i,r (c_i,r - t_i,r) + T_r )
//
//   c_i,r, t_i,r   what the r-th try for failure i costs, and the part of it that its time is
//   p_i,r          the chance that failure i is still there then: a of those before (value.h)
//   T_r            the expectation of the longest t_i,r of those that are: with the failures in the
//                  order of t, longest first, sum_i t_i,r p_i,r prod_{k before i} (1 - p_k,r)
//
// One alone has its cheapest order anyway (value.h). Two that would each be restarted first may
// both be replaced at once: neither then waits for the other's replacement.
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
