// Knowledge -> failures, and verdicts on the strategies under way (paper, "Analyzing").
//
// Only rules whose trigger can have changed, or whose own time has come, are looked at. The states
// of a rule:
//
//   detected   its trigger held for its policy's time (FOR, HOLD n/k) and its COOLDOWN is over.
//              (detector.h)
//   resolved   its trigger was false for its policy's time; unknown is neither true nor false
//   blind      its trigger has been unknown for a while: neither quiet nor failing (blind_watch.h)
//   proven     it stayed resolved for `healthy`. A failure that is back before that is the same
//              one: its strategies stay tried, and its attempts and rounds go on counting. One
//              that keeps coming back is reported as flapping
//
// When the verdict on a strategy under way is due, and which it is: due_verdicts.h.
//
// A round of strategies is followed by a back-off that doubles each time. After ATTEMPTS strategies
// (or as many rounds without any valid strategy) the rule is exhausted. A process that is known to be gone
// is started again all the same, for ever, with a back-off of up to five minutes, and teaches nothing.
//
// LASTRESORT strategies are no part of the rounds (last_resorts.h).
//
// A rule with ON_CHANGE acts once on the rising edge of its trigger; its strategy succeeds when its
// adaptations took effect, because the condition is expected to last.
//
// Success and failure go to the beliefs only where this strategy alone can have caused them: the
// symptom went away after the first request that changed anything, and no other strategy upstream
// of it was under way or had only just ended; and only once that is proven (outcome_watch.h).
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "analyze/blind_watch.h"
#include "analyze/coupling_watch.h"
#include "analyze/detector.h"
#include "analyze/due_verdicts.h"
#include "analyze/last_resorts.h"
#include "analyze/lateness_watch.h"
#include "analyze/left_off.h"
#include "analyze/outcome_watch.h"
#include "analyze/parameter_fights.h"
#include "knowledge/deadlines.h"
#include "knowledge/history.h"
#include "knowledge/knowledge.h"

namespace culprit {

class Analyzer {
 public:
  // Between two starts of a process that is known to have exited, once the rule is exhausted:
  // doubled each time.
  static constexpr Duration kFirstPauseOfStarts = std::chrono::seconds(10);
  static constexpr Duration kLongestPauseOfStarts = std::chrono::minutes(5);
  // A failure that is back within so long may be an effect that its cause brought back.
  static constexpr Duration kRecurs = std::chrono::seconds(5);
  // A failure that its own strategy cleared goes on if it is back within so long; later it begins anew.
  static constexpr Duration kOutlasts = std::chrono::seconds(2);
  // An exhausted failure that is unknown for so long explains nothing any more.
  static constexpr Duration kExhaustedLostAfter = std::chrono::minutes(5);
  // A failure that came so often, each time before it was proven gone, flaps.
  static constexpr int kFlaps = 3;

  // What it writes; all else it only reads.
  struct Writes {
    RuleStates& states;
    SignalStore& signals;  // takes the rules that were touched
    Beliefs& beliefs;
    Couplings& couplings;
    Latencies& latencies;
    Coincidences& coincidences;
    Transients& transients;
    PendingOutcomes& outcomes;
    Blindness& blindness;
    EventLog& events;
  };

  // `knowledge` must outlive the analyzer. Watching begins at `start`; the robot has its time to show
  // itself until `discovered`.
  Analyzer(const Knowledge& knowledge, Writes writes, Time start, Time discovered);

  // The attempts of earlier processes. Before the first advance().
  void remember(const History& past);

  // culprit did not watch until `now`. Every time that must pass without a break begins anew (FOR,
  // HOLD, a strategy's waiting time). The strategies under way prove nothing, however they end.
  void restart(Time now);

  // Looks at every rule that the monitor touched and at those whose time has come.
  void advance(Time now);
  // Looks which rules are blind. Once a step, at its end: no plan depends on it.
  void look_for_blind(Time now) { blind_.advance(now); }
  Time next_deadline() const {
    return std::min({deadlines_.next(), couplings_.next_deadline(), outcomes_.next_deadline(),
                     blind_.next_deadline()});
  }

  // Failures that a planner should decide about now, ascending: there, and no strategy under way,
  // no back-off.
  std::vector<RuleId> plannable(Time now) const;
  // Whether anything may have to be done, for steps where nothing is wrong.
  bool anything_to_do(Time now) const;
  // Is the rule exhausted, and would a strategy of it only start processes that are known to have
  // exited? Such starts go on, with back-off.
  bool goes_on(RuleId id) const;
  // When the first of these is due; kNever if none is.
  Time next_start() const;

  // The rule's strategy under way ends without a verdict.
  void abandon(RuleId id, Time now);
  // As abandon(), for a last resort. If the strategy has changed anything, that may be why the last resort is due: it was an
  // attempt in vain.
  void yield_to_last_resort(RuleId id, Time now);

  // The rule's strategy under way, which has taken effect, leaves its components to `other`. If its
  // changes stay, it is judged when it has the components back; else it ends without a verdict.
  void make_way(RuleId id, StrategyId other, Time now);

  LastResorts& last_resorts() { return last_resorts_; }

  // culprit may not do more about the failure by itself: a person must look.
  void give_up(RuleId id, Time now);

  // A computer became unreachable. Attempts at failures that it explains, made in vain shortly before
  // that was known, are forgotten; an outcome that is not proven yet is not learned.
  void forgive_unheard(Time now);

  // No untried strategy of the rule is valid: its round is over.
  void round_is_spent(RuleId id, Time now);

 private:
  void look_at(RuleId id, Time now);
  void evaluate_trigger(RuleId id, Time now);
  void forget_left_off(RuleId id, Time now);
  bool is_gone(RuleId id, Time now) const;

  bool is_proven(Time gone, Time now) const;
  void detect(RuleId id, Time now);
  void watch_failing(RuleId id, Time now);
  void leave(RuleId id, Time now);
  void unmask_effects_of(RuleId gone, Time now);
  Time masked_until(RuleId effect) const;
  void judge(RuleId id, Time now);
  void end_attempt(RuleId id, Time now);
  void succeed(RuleId id, Time now);
  void fail(RuleId id, Time now);
  void excuse(RuleId id, std::string why, Time now);
  Time lost_at(RuleId id) const;
  void excuse(RuleId id, ComponentId unheard, Time now);
  void resolve(RuleId id, FailureResolved how, Time now);
  void exhaust_if_spent(RuleId id, Time now);
  void take_back_starts(RuleId id);
  void note_ready(RuleId id, const Attempt& attempt);
  void exhaust(RuleId id, Time now);
  void stay_exhausted(RuleId id, Time now);
  void note_latency(RuleId id, Time effective);
  void note_transient(RuleId id);
  void note_that_it_stayed(RuleId id);
  void note_coincidence(RuleId id);
  void schedule(RuleId id, Time now);

  const Knowledge& knowledge_;
  Writes write_;
  Deadlines deadlines_;  // by RuleId
  BlindWatch blind_;
  Detector detector_;
  DueVerdicts verdicts_;
  LeftOffSearches left_off_;
  CouplingWatch couplings_;
  LatenessWatch lateness_;
  OutcomeWatch outcomes_;
  ParameterFights fights_;
  LastResorts last_resorts_;
};

}  // namespace culprit
