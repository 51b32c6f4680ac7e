// Simple planners that a root-cause analysis has to beat, on the same manager.
//
// Each puts the failures in an order and repairs the first of them, one at a time, with its
// cheapest strategy that was not tried yet (paper, Eq. 1):
//   first-failing  by the time of detection
//   topological    those with the fewest failures upstream first; a circle counts for all in it
//   random-walk    by how often a walker comes by that goes from a failure to a random one upstream
//                  of it, and with probability 0.15 to any, as MonitorRank and its followers do
//
// Those that wait for evidence are in timing_planners.h. Two more are the paper's planner: "naive" without its dependency graph, so that each failure is
// repaired alone, and "paper".
#pragma once

#include <vector>

#include "plan/planner.h"

namespace culprit::study::rca {

// The failure's strategies, cheapest first (paper, Eq. 1), with why some cannot be tried; none is
// chosen.
Decision cheapest_first(RuleId failure, const Knowledge& knowledge);

enum class Ranking : std::uint8_t { kFirstFailing, kTopological, kRandomWalk };

class RankingPlanner : public Planner {
 public:
  explicit RankingPlanner(Ranking ranking) : ranking_(ranking) {}
  std::vector<Decision> plan(std::span<const RuleId> failures,
                             const Knowledge& knowledge) const override;

 private:
  std::vector<double> ranks(const Knowledge& knowledge) const;  // of the active rules; low is first

  Ranking ranking_;
};

}  // namespace culprit::study::rca
