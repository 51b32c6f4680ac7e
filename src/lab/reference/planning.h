// The reference's planning: strategies for the failures that wait.
//
// Each level by itself, from ERROR down: all strategies of its waiting rules, cheapest first, and
// each is chosen that
//   - was not tried;
//   - adapts no component that is busy, or that was chosen for and was not seen busy since
//   (`reserved`);
//   - with D: adapts no component that depends on one that is at least as sick as the level (D and
//     C), or on one of those that is reserved (D alone);
//   - is the first for its rule.
// Whether a strategy makes sense now is not asked. A healthy component is as sick as the lowest
// level, so that with D and C nothing of that level is chosen for a component that depends on any.
#pragma once

#include <vector>

#include "reference/analysis.h"
#include "reference/cost.h"
#include "reference/execution.h"
#include "reference/graph.h"

namespace culprit::study::reference {

class Planning {
 public:
  // `rules` must outlive the planning.
  Planning(const RuleSet& rules, const ReferenceOptions& options);

  // One tick. The result is valid until the next tick.
  const std::vector<StrategyId>& advance(Time now, const Analysis& analysis,
                                         const Execution& execution, const Graph& graph,
                                         std::vector<Event>& events);

 private:
  struct Present {
    const Analysis& analysis;
    const Execution& execution;
    const Graph& graph;
  };

  std::vector<Candidate> candidates(Criticality level, const Analysis& analysis) const;
  void select(Criticality level, const Present& present);
  void examine(Candidate& candidate, Criticality level, const Present& present) const;
  bool depends_on_sick(Candidate& candidate, Criticality level, const Present& present) const;
  void tell(Time now, std::span<const RuleId> failures, std::vector<Event>& events);

  const RuleSet& rules_;
  PaperSwitches switches_;
  Costs cost_;
  std::vector<bool> reserved_;  // by component
  std::vector<StrategyId> chosen_;
  std::vector<std::vector<Candidate>> decisions_;  // by rule, of this tick
  std::vector<std::vector<Candidate>> said_;       // by rule, why it waits, as it was told last
};

}  // namespace culprit::study::reference
