// The strategies under way, as their execution writes them: a part of the states of rules.
//
//     begin -> change_begins -> took_effect -> (analysis: the verdict) | undo -> undone
//              obstruct ------------------------^
//
// What the analysis writes (verdicts, suspensions) is not here.
#pragma once

#include <string>

#include "knowledge/rule_states.h"

namespace culprit {

class Attempts {
 public:
  // `states` must outlive it.
  explicit Attempts(RuleStates& states) : states_(states) {}

  // @pre none of the rule is under way
  void begin(StrategyId strategy, Time now);
  // An undo that an earlier attempt of the strategy owes, and nothing else. @pre as begin()'s; the rule is quiet
  void give_back(StrategyId strategy, Time now);
  // One that an earlier process began; culprit did not watch meanwhile. @pre as begin()'s
  void resume(StrategyId strategy, Time now);

  // Each of these: @pre the strategy is under way.
  // The first request goes out that changes anything.
  void change_begins(StrategyId strategy, Time now);
  // The last adaptation has taken effect.
  void took_effect(StrategyId strategy, Time now);
  // A process that it had started exited, and is started again.
  void adapts_again(StrategyId strategy);
  // An adaptation could not be carried out.
  void obstruct(StrategyId strategy, std::string obstacle);
  // Its outcome proves nothing.
  void make_ambiguous(StrategyId strategy);
  // An earlier process found that it failed: it is being undone.
  void undo(StrategyId strategy);
  // Its undo is complete.
  void undone(StrategyId strategy);

 private:
  Attempt& of(StrategyId strategy);

  RuleStates& states_;
};

}  // namespace culprit
