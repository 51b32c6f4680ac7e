// Failures that repeatedly begin together although the graph shows no path between their components:
// two nodes may share a port, a bus or a power rail.
//
//   n_ij   how often failures i and j began together
//   n_i    how often i began
//
// i and j coincide if n_ij >= kLeast and n_ij >= kShare min(n_i, n_j). Then their repairs are staggered,
// the one first this time and the other the next, so that one can see which repair clears the other
// (Couplings).
#pragma once

#include <map>
#include <span>
#include <vector>

#include "language/rule_set.h"

namespace culprit {

class Coincidences {
 public:
  static constexpr int kLeast = 2;
  static constexpr double kShare = 0.6;
  // More failures at once than this are counted as one event, not as pairs.
  static constexpr std::size_t kMostTogether = 16;

  explicit Coincidences(const RuleSet& rules) : began_(rules.rules.size(), 0) {}

  // The failure began, together with these others.
  void began(RuleId rule, std::span<const RuleId> others);

  // n_ij
  int together(RuleId a, RuleId b) const;
  bool coincide(RuleId a, RuleId b) const;
  // The rules that coincide with it, ascending.
  std::vector<RuleId> of(RuleId rule) const;

 private:
  static std::pair<RuleId, RuleId> ordered(RuleId a, RuleId b) {
    return a < b ? std::pair(a, b) : std::pair(b, a);
  }

  std::vector<int> began_;
  std::map<std::pair<RuleId, RuleId>, int> together_;
};

}  // namespace culprit
