// The LASTRESORT strategies of a rule, which are no part of its rounds.
//
// They are due WITHIN their time of the detection, or earlier if no other strategy can begin or help
// by then, and go beside whatever is under way. They have no verdict: their changes stay while the
// failure is there, and the other strategies go on. One that could not be carried out is tried again
// with back-off, up to ATTEMPTS times, and meanwhile the next one begins in its time. Each new
// process of its components gives it one more try: the one before may have ended while it began. Several
// follow each other by WITHIN, each after the impact of the one before.
#pragma once

#include <optional>
#include <vector>

#include "analyze/coupling_watch.h"
#include "analyze/parameter_fights.h"
#include "knowledge/history.h"
#include "knowledge/knowledge.h"

namespace culprit {

class LastResorts {
 public:
  struct Writes {
    RuleStates& states;
    EventLog& events;
    CouplingWatch& couplings;
    ParameterFights& fights;
  };

  // All must outlive it.
  LastResorts(const Knowledge& knowledge, Writes writes) : knowledge_(knowledge), write_(writes) {}

  // The one that comes next, due or not; empty: each took effect, or there is none.
  std::optional<StrategyId> next(RuleId id) const;
  // Those that have to be begun now, one at a time: the first of these that can be.
  std::vector<StrategyId> due(RuleId id, Time now) const;
  // No other strategy of the rule can begin or help in time: they are due, if there are any.
  void turn_to(RuleId id, Time now);
  // Has the one under way had no effect, although the time of the next one has come? It cannot
  // wait for a service that does not answer.
  bool has_to_give_way(RuleId id, Time now) const;
  // The one under way is abandoned, and tried again later. @pre there is one
  void give_way(RuleId id, Time now);
  // The one under way is abandoned. @pre there is one
  void abandon(RuleId id, Time now);
  // The one under way, if any: it took effect, or could not be carried out.
  void judge(RuleId id, Time now);
  // Those whose changes a new process has lost, or that its predecessor refused, are tried again. The
  // time of the next may have come.
  void watch(RuleId id, Time now);

  // The one whose effect the failure went away by: in the time that the latest one had for that, and
  // while no other strategy of the rule was under way. Empty: there is none.
  std::optional<StrategyId> that_helped(RuleId id) const;
  // When the next one may be due; kNever: there is none.
  Time next_time(RuleId id) const;

 private:
  bool is_left(StrategyId strategy) const;
  // When it is due.
  Time begins(RuleId id, StrategyId strategy) const;

  const Knowledge& knowledge_;
  Writes write_;
};

}  // namespace culprit
