// The failures that are there now, and which may be the cause of which. Also exhausted ones whose
// trigger is true: they still explain others.
//
// Failure j may be the cause of failure i if a component that j touches is upstream of one that i
// touches, by a way that i can have taken (plan/bayes/failure_paths.h), however critical either is (but a
// bad value that is only ever reconfigured is no cause of what is more critical): how bad a cause
// is, its effects say (plan/bayes/levels.h). Failures that may be the causes of each other,
// directly or round several corners, form a circle; that needs no circle in the graph, because a
// rule may touch several components.
//
// They are in the order of their rules' names, so that nothing depends on the order of
// declarations.
#pragma once

#include <vector>

#include "plan/bayes/failure_paths.h"

namespace culprit::plan {

inline constexpr std::size_t kLevels = 3;  // of criticality

class Failures {
 public:
  // `reach` holds all components that these rules touch; `paths` are made of it.
  Failures(const Knowledge& knowledge, const Reach& reach, const FailurePaths& paths);

  std::size_t size() const { return rules_.size(); }
  RuleId operator[](std::size_t i) const { return rules_[i]; }
  bool holds(RuleId rule) const { return places_[rule.index] != kAbsent; }
  // @pre holds(rule)
  std::size_t index_of(RuleId rule) const;

  // The possible causes of failure i outside its own circle.
  std::span<const Word> causes(std::size_t i) const { return causes_[i]; }
  // The failures of circle c; most consist of one.
  std::size_t circle_of(std::size_t i) const { return circle_of_[i]; }
  const std::vector<std::vector<std::size_t>>& circles() const { return circles_; }

 private:
  static constexpr std::size_t kAbsent = static_cast<std::size_t>(-1);

  void find_circles(const BitRows& effects);

  std::vector<RuleId> rules_;
  std::vector<std::size_t> places_;  // in rules_, by RuleId
  BitRows causes_;
  std::vector<std::size_t> circle_of_;
  std::vector<std::vector<std::size_t>> circles_;
};

}  // namespace culprit::plan
