// Failures that repeatedly begin together although the graph shows no path between their components:
// two nodes may share a port, a bus or a power rail.
//
//   n_ij   how often failures i and j began together
//   n_i    how often i began
//
// i and j coincide if n_ij >= kLeast and n_ij >= kShare min(n_i, n_j). Then their repairs are staggered,
// the one first this time and the other the next, so that one can see which repair clears the other
// (Couplings).
//
// The journal keeps the counts, but no step waits until they are on the disk: a culprit that is killed may
// lose the last one. A failure that an earlier process detected does not begin again with the next one.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "language/rule_set.h"

namespace culprit {

class Coincidences {
 public:
  static constexpr int kLeast = 2;
  static constexpr double kShare = 0.6;
  // More failures at once than this are counted as one event, not as pairs.
  static constexpr std::size_t kMostTogether = 16;
  static constexpr int kMost = 1'000'000'000;  // counts no further

  using Pair = std::pair<RuleId, RuleId>;  // the lesser one first

  explicit Coincidences(const RuleSet& rules) : rules_(rules.rules.size()) {}

  // The failure began, together with these others.
  void began(RuleId rule, std::span<const RuleId> others);

  // n_i
  int times(RuleId rule) const { return rules_[rule.index].began; }
  // n_ij
  int together(RuleId a, RuleId b) const;
  const std::map<Pair, int>& pairs() const { return together_; }
  // Those that began together with it at least once, ascending.
  std::span<const RuleId> partners(RuleId rule) const { return rules_[rule.index].partners; }
  bool coincide(RuleId a, RuleId b) const;
  // The rules that coincide with it, ascending.
  std::vector<RuleId> of(RuleId rule) const;

  // For counts of an earlier run: n_ab, or n_a if both are the same rule.
  void set(RuleId a, RuleId b, int count);
  // All counts of the rule are zero.
  void forget(RuleId rule);

  // Grows with each call of these three that names the rule first: n_i, or n_ij of a partner, may be another then.
  // A copy of the counts is compared rule by rule with it, and not pair by pair.
  std::uint64_t changes(RuleId rule) const { return rules_[rule.index].changes; }

 private:
  struct OfRule {
    int began = 0;
    std::vector<RuleId> partners{};
    std::uint64_t changes = 0;
  };
  static Pair ordered(RuleId a, RuleId b) { return a < b ? Pair(a, b) : Pair(b, a); }
  int& count_of(RuleId a, RuleId b);

  std::vector<OfRule> rules_;
  std::map<Pair, int> together_;
};

}  // namespace culprit
