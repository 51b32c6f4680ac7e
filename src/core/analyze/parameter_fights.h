// Two rules that pull one parameter to and fro.
//
// A strategy sets a parameter and resolves its failure; a strategy of a less critical rule then sets
// the same parameter; the failure is back within kSoon. Two such turns are evidence enough: from then on
// all less critical strategies that pull it to that side are barred, and the more critical rule's value stays, until the parameter's process
// begins anew (plan/validity.h). A last resort proves nothing: it is meant to be taken back, and its failure may come again for its own reasons.
#pragma once

#include <optional>
#include <vector>

#include "knowledge/knowledge.h"

namespace culprit {

class ParameterFights {
 public:
  // A battery that is low once more after an hour was not emptied by the rule that noticed its charge.
  static constexpr Duration kSoon = std::chrono::minutes(10);

  // Both must outlive it.
  ParameterFights(const Knowledge& knowledge, RuleStates& states);

  // The strategy's adaptations took effect, or are about to.
  void took_effect(StrategyId strategy);
  // The rule's failure was detected, perhaps once more.
  void detected(RuleId rule, Time now);

 private:
  std::optional<bool> pulls_up(StrategyId id, StrategyId own, ParameterId parameter) const;
  void bar(StrategyId loser, StrategyId own, ParameterId parameter, Time now);

  struct Setters {
    std::optional<StrategyId> last;
    std::optional<StrategyId> before;  // another one
    Time since = kLongAgo;             // `last` took effect
  };

  const Knowledge& knowledge_;
  RuleStates& states_;
  std::vector<Setters> setters_;  // by parameter
};

}  // namespace culprit
