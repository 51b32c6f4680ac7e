// The failures that wait for planning, in the order in which the reference's planner sees them.
//
// The public code keeps them in std::unordered_set of addresses. GNU's gives the element inserted
// last first, but elements whose addresses fall into one of its 13 buckets stay together. If
// strategies have equal cost, that order decides: std::sort keeps the order of up to 16 equal
// elements.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/ids.h"

namespace culprit::study::reference {

class SentRules {
 public:
  // Deals `rules` rules their buckets. 0: each its own.
  SentRules(std::size_t rules, std::uint64_t seed);

  void insert(RuleId rule);
  void erase(RuleId rule);
  std::span<const RuleId> in_order() const { return order_; }

 private:
  std::vector<std::size_t> buckets_;  // by rule
  std::vector<RuleId> order_;
};

}  // namespace culprit::study::reference
