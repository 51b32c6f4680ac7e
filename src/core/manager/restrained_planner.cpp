#include "manager/restrained_planner.h"

#include <algorithm>
#include <utility>

#include "execute/evidence.h"
#include "plan/allowed.h"

namespace culprit {
namespace {

std::optional<Knowledge::Withheld> objection(StrategyId id, const Knowledge& knowledge) {
  const Strategy& strategy = knowledge.rules[id];
  if (auto doubt = execute::doubt_of_identity(strategy, knowledge))
    return Knowledge::Withheld{.reason = std::move(*doubt)};
  if (auto reason = execute::launch_of_the_unseen(strategy, knowledge))
    return Knowledge::Withheld{.reason = std::move(*reason)};
  if (auto reason = execute::contradiction(strategy, knowledge, knowledge.now))
    return Knowledge::Withheld{.reason = std::move(*reason), .is_contradicted = true};
  return std::nullopt;
}

}  // namespace

// The knowledge is copied only where the governor withholds something: that is seldom, and what-if
// questions ask for very many plans.
std::vector<Decision> RestrainedPlanner::plan(std::span<const RuleId> failures,
                                              const Knowledge& knowledge) const {
  std::vector<Decision> decisions = planner_.plan(failures, knowledge);
  const bool is_any_withheld =
      std::any_of(decisions.begin(), decisions.end(),
                  [&](const Decision& v) { return v.chosen && objection(*v.chosen, knowledge); });
  if (!is_any_withheld) return decisions;
  Knowledge marked(knowledge.rules, knowledge);
  return plan::allowed(planner_, failures, marked, [&](StrategyId chosen) {
    auto withheld = objection(chosen, marked);
    const bool is_withheld = withheld.has_value();
    if (is_withheld) marked.withheld[chosen.index] = std::move(*withheld);
    return is_withheld;
  });
}

}  // namespace culprit
