// The paths along which a failure can have spread: the graph without the healthy parts.
//
// A chain of effects does not go through a component that shows none. Left out, for failures of one
// kind of symptom (an outage, or a bad value), are
//   - components that are well: a rule of that kind touches them and is quiet, no rule that touches
//     them fails or is imminent, none of their topics has become slow, and they are in no trouble. Bad
//     data may end their consumer, though they arrive, unless the rule only reconfigures. A rule that
//     tells nothing of data (timing.h) does not count: that a node answers or is active is no proof
//     that anything comes through it;
//   - topics and services that evidently carry no failures: of n consumers that are well or
//     fail, more are well than kSpared n and kDeviations standard deviations of the binomial
//     distribution. /tf and its like are read by many. A consumer that is quiet counts once its rules would have
//     fired for the failure of the producer: it may go on for a while with what it has.
// A failure for which evidence can still come (awaited.h) has the whole graph: a quiet rule between
// may only not have fired yet.
//
// This separates causes from components that are merely upstream: on a robot with feedback loops, or
// with topics that all nodes read, everything is upstream of everything.
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
