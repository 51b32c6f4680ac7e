// How the reference manager behaves: as the authors' public code, or, slip by slip, as their paper
// says.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "base/time.h"
#include "base/value.h"
#include "plan/paper_planner.h"

namespace culprit::study {

// Where the public code does something else than the paper says. True: as the code.
struct Slips {
  bool frozen_graph = true;  // dependencies as they were at the start, for good
  // One health for each component: a later rule overwrites it, and any resolved rule that touches
  // the component sets it to OK. Otherwise it is the highest level of its failing rules.
  bool overwritten_health = true;
  bool weighted_cost = true;      // not Eq. 1 (reference/cost.h)
  bool summed_impact = true;      // a strategy's impact in the cost is the sum over its adaptations
  bool resent_parameters = true;  // every set_parameter sends all earlier ones of its component too
  bool fixed_beliefs = true;      // nothing is learned

  // The paper as meant.
  static Slips none() { return {false, false, false, false, false, false}; }
};

// The weight of an adaptation in the cost, and how many ticks its strategy gets.
enum class ImpactTable : std::uint8_t {
  kCode,      // by type, as the manager that is built
  kStray,     // by type, as a second copy of that file in its include folder
  kRuleFile,  // as the rules say: the paper's way
};

struct ReferenceOptions {
  // S as in the paper. D alone holds back only what depends on a component that was just chosen; C
  // without D does nothing, in the public code.
  PaperSwitches switches;
  ImpactTable impacts = ImpactTable::kCode;
  Slips slips;

  Time start{};            // of the first tick; the others follow, one each CYCLE of the rules
  Time graph_frozen_at{};  // the first tick from here on takes the snapshot (slip frozen_graph)

  // The blackboard's initial value of each signal of the rules, before its first reading.
  std::map<std::string, Value> initial;

  // Strategies of equal cost go in the order of a hash set of addresses (reference/sent_rules.h);
  // the seed deals the addresses. 0: none collide, so that the failure detected last goes first.
  std::uint64_t seed = 0;
};

}  // namespace culprit::study
