// Which failures go away with which: learns the couplings, and says who is expected to settle.
//
// When a strategy has resolved failure j, every other failure i that is there has until its signals
// would show it to go away too. If it does, i is coupled to j; if it is still there, it is not. An
// outcome counts only if nothing but j's strategy can have caused it: no other change of the system
// between that strategy's first request and the outcome could resolve i, and none was made for i
// itself.
#pragma once

#include <vector>

#include "knowledge/knowledge.h"

namespace culprit {

class CouplingWatch {
 public:
  // What would show a failure gone may stay silent: nobody waits longer than this.
  static constexpr Duration kPatience = std::chrono::seconds(30);
  // More failures at once than this, and what is learned from them is left to quieter times.
  static constexpr std::size_t kMostWatched = 1000;

  // `knowledge` must outlive the watch.
  explicit CouplingWatch(Knowledge& knowledge) : knowledge_(knowledge) {}

  // `attempt` resolved its failure, which nothing else can have done (`is_proven`), or it may have.
  void resolved(const Attempt& attempt, bool is_proven, Time now);
  // A failure went away without a strategy of its own.
  void cleared(RuleId rule, Time now);
  void ended(const Attempt& attempt, Time now);

  void advance(Time now);
  Time next_deadline() const;

 private:
  // Is i coupled to j? Open until i goes away, or `due`.
  struct Question {
    StrategyId strategy;  // that resolved j
    RuleId effect;        // i
    Time since;           // the strategy's first request
    Time detected;        // when i was
    Time due;
    Time abandoned;
  };
  struct Change {
    StrategyId strategy;
    Time begin;
    Time end;
  };
  struct Clearing {
    RuleId rule;
    Time at;
  };

  void settle(StrategyId strategy, RuleId effect, Time now);
  bool is_only_cause(StrategyId strategy, RuleId effect, Time since) const;
  void forget_what_is_settled(Time now);

  Knowledge& knowledge_;
  std::vector<Question> questions_;
  std::vector<Change> changes_;      // that are over
  std::vector<Clearing> clearings_;  // of failures without a strategy of their own
};

}  // namespace culprit
