// The paths along which a failure can have spread: the graph without the parts that evidently passed nothing on.
//
// A failure does not spread through a component that shows no effect of it. For failures of one symptom (an outage, or a
// bad value), these are left out:
//   - components that are well. All of this holds for such a component:
//       - a quiet rule about it would show the symptom. A rule that tells nothing of data (timing.h) does not count: a node
//         that answers or is active may still pass no data on;
//       - no rule about it fails or is imminent for an outage, nor, if the symptom is a bad value, for a value;
//       - no bad value of it may end the data of its consumers. A value may, unless its rule has ON_CHANGE; or only
//         reconfigures, and no DEPENDENCY names the component as a supplier;
//       - no steady topic of it has become slow;
//       - it is in no trouble (trouble.h);
//   - topics and services through which evidently nothing spreads, such as /tf, which many read. n consumers are well or
//     fail, and more of them are well than kSpared n plus kDeviations standard deviations of the binomial distribution. A
//     quiet consumer counts once its rules would have fired for the producer's failure: it may go on for a while.
// For a failure for which evidence can still come (awaited.h), nothing is left out: a quiet rule between may fire yet.
//
// On a robot with feedback loops, or with topics that all nodes read, everything is upstream of everything. This separates
// the causes from components that are merely upstream.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "diagnose/awaited.h"
#include "diagnose/reach.h"
#include "diagnose/trouble.h"

namespace culprit::diagnose {

// The share of consumers that a failure spares, or does not reach at once.
inline constexpr double kSpared = 0.25;
inline constexpr double kDeviations = 3;

class Paths {
 public:
  // All must outlive it. `whole` has the components that matter, by the whole graph. `imminent`: all
  // rules that are (imminent.h); `troubles` by component.
  Paths(const Knowledge& knowledge, const Reach& whole, const Awaited& awaited,
        std::span<const RuleId> imminent, std::span<const std::optional<TroubleSeen>> troubles);

  // The places from which the failure of `rule` at `place` can have come.
  std::span<const Word> upstream(std::size_t place, RuleId rule) const;

 private:
  bool has_whole_graph(RuleId rule) const;

  const Knowledge& knowledge_;
  const Reach& whole_;
  const Awaited& awaited_;
  std::array<std::optional<Reach>, 2> narrowed_;  // by Symptom; empty: nothing is left out
};

}  // namespace culprit::diagnose
