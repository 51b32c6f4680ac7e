// What begins together passes together.
//
// The set of the highest worth (conflict_free_set.h) counts the time of each of its strategies,
// though the robot waits only for the longest. So for each of its failures the strategy is taken
// that costs the least beyond the time that the longest of the others takes anyway:
//
//     argmin_s E_s - min(t_s, T_i)
//
//   E_s   the expected cost of repairing failure i beginning with s (plan/bayes/value.h)
//   t_s   what the time of s costs: a part of E_s
//   T_i   the longest t of what was chosen for the other failures
//
// among those that adapt the same components, so that no conflict comes of it.
#pragma once

#include <vector>

#include "plan/bayes/bit_rows.h"

namespace culprit::plan {

struct Timed {
  std::size_t failure = 0;
  double cost = 0;              // E
  double time = 0;              // t
  std::span<const Word> takes;  // places
};

// `chosen` are indices into `options`, one for each of some failures; so is what is given back, in
// the same order of failures. Among equals the one that was chosen, then the first.
std::vector<std::size_t> side_by_side(std::span<const Timed> options,
                                      std::vector<std::size_t> chosen);

}  // namespace culprit::plan
