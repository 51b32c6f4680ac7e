// The paths along which a failure can have spread: the graph without what is seen to be well.
//
// A chain of effects does not go through a component that shows none. Left out, for failures of one
// kind of symptom (an outage, or a bad value), are
//   - components that are well: a rule of that kind touches them and is quiet, and no rule that
//     touches them fails or is suspicious; a component that sends has no outage, however bad the
//     values are;
//   - topics and services that evidently carry no failures: of n consumers that are well or
//     fail, more are well than kSpared n and kDeviations standard deviations of the binomial
//     distribution. /tf and its like are read by many.
// A young failure has the whole graph: what lies between may only not have been detected yet.
//
// This separates causes from what is merely upstream: on a robot with circles, or with topics that
// everybody reads, everything is upstream of everything.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "plan/bayes/reach.h"

namespace culprit::plan {

// The share of consumers that a failure spares, or does not reach at once.
inline constexpr double kSpared = 0.25;
inline constexpr double kDeviations = 3;

class FailurePaths {
 public:
  // Both must outlive it. `whole` has the components that matter, by the whole graph. `suspicious`:
  // all that are (plan/bayes/suspicion.h).
  FailurePaths(const Knowledge& knowledge, const Reach& whole, std::span<const RuleId> suspicious);

  // The places from which the failure of `rule` at `place` can have come.
  std::span<const Word> upstream(std::size_t place, RuleId rule) const;

 private:
  const Knowledge& knowledge_;
  const Reach& whole_;
  std::array<std::optional<Reach>, 2> narrowed_;  // by Symptom; nothing: nothing is left out
};

}  // namespace culprit::plan
