// Learns the couplings (which failures clear together), and decides which failures are expected to
// settle.
//
// When a strategy has resolved failure j, every other present failure i gets as long as its signals
// need to show a change, or until the first fresh reading; an outage as long as it may be an echo (diagnose/awaited.h).
// Planners wait as long as well.
// If i has cleared by then, it is coupled to j; otherwise it is not. The outcome counts only if
// nothing but j's strategy can have caused it:
//   - no other change of the system between that strategy's first request and the outcome could
//     have resolved i,
//   - no change was made for i itself,
//   - no earlier change can have taken effect only now,
//   - no other failure upstream of i cleared by itself.
//
// Exposure counts without any repair. When j ends, each failure i downstream that stayed away, and would
// have been seen, counts as apart from j: once for each diagnose::kUsualDelay that j lasted. One exposure
// counts at most kLongestExposure times: j may be worse the next time.
//
// A failure goes away as slowly as it came: if i was detected some time after j, it is given one
// and a half times that long to go away after j. Until then i is said to settle, and planners leave
// it alone. A flapping cause may leave effects of an earlier time behind.
#pragma once

#include <optional>
#include <vector>

#include "knowledge/knowledge.h"

namespace culprit {

class CouplingWatch {
 public:
  // Signals that would show the recovery may stay silent: the watch ends after this time.
  static constexpr Duration kPatience = std::chrono::seconds(30);
  // At most this many open questions; outcomes beyond them are not learned.
  static constexpr std::size_t kMostWatched = 1000;
  // An effect that comes or goes later than so long after its cause is taken for none.
  static constexpr Duration kLongestDelay = std::chrono::seconds(5);
  // How late an effect usually comes; for one from the time before: how long it may take to go.
  static constexpr Cycles kUsualDelay{10};
  static constexpr double kLongestExposure = 10;

  // What it writes; all else it only reads.
  struct Writes {
    RuleStates& states;  // what is expected to settle
    Couplings& couplings;
    Latencies& latencies;  // how long after its effects a cause was detected
  };

  // `knowledge` must outlive the watch.
  CouplingWatch(const Knowledge& knowledge, Writes writes)
      : knowledge_(knowledge), write_(writes) {}

  // `attempt` resolved its failure, which nothing else can have done (`is_proven`), or it may have.
  void resolved(const Attempt& attempt, bool is_proven, Time now);
  // A failure cleared without a repair of its own.
  void cleared(RuleId rule, Time now);
  // The failure ends, with a repair or without: which ones did not follow it?
  void exposed_others(RuleId cause, Time now);
  void ended(const Attempt& attempt, Time now);
  // Can a change that was made for another failure just before `attempt` have resolved its own?
  bool is_echo(const Attempt& attempt) const;
  // The failure of `rule` clears. Did no change that can have cleared it take effect since it began, and
  // was no trouble upstream over meanwhile?
  bool is_unaided(RuleId rule) const;

  // Has a strategy of another rule changed something since then that can have cleared the failure of `rule`: upstream of
  // it, or for a failure that coincides with it, or was seen to clear it?
  bool is_changed_since(RuleId rule, Time since) const;

  // culprit did not watch for a while: failures that cleared meanwhile count as coupled to none.
  void restart() { questions_.clear(); }

  void advance(Time now);
  Time next_deadline() const;

 private:
  // Is i coupled to j? Open until i clears, or `due`.
  struct Question {
    StrategyId strategy;  // that resolved j
    RuleId effect;        // i
    Time since;           // the strategy's first request
    Time detected;        // when i was
    Time gone;            // when i may have cleared with j
    Time shown;           // from then on a fresh reading answers it
    Time due;             // or at the latest this
    Time abandoned;
    Duration fired;  // how late j was detected, if i is its effect
  };
  struct Change {
    StrategyId strategy;
    Time begin;
    Time effective;
    Time end;
  };
  struct Clearing {
    RuleId rule;
    Time gone;   // its trigger became false
    Time at;     // it cleared
    Time began;  // at the latest
  };

  void settle(const std::vector<ComponentId>& repaired, RuleId cause, Time changed,
              std::optional<Cycles> on_its_way, Time now);
  bool is_well_after(Time since, RuleId rule) const;
  Duration held(RuleId rule) const;
  Time last_change_for(RuleId cleared, Time now) const;
  Time gone_since(RuleId rule, Time now) const;
  Duration delay(RuleId cause, RuleId effect) const;
  Time echo_of(RuleId cause, RuleId effect, Time now) const;
  Duration fired_after(Time began, RuleId cause) const;
  void note_fired(RuleId cause, Duration after);
  Time shown(const Change& change, RuleId rule) const;
  Time shown_after_all(const Change& change, RuleId rule) const;
  bool has_supply_back(RuleId rule) const;
  bool is_only_cause(StrategyId strategy, RuleId effect, Time since) const;
  void forget_what_is_settled(Time now);

  const Knowledge& knowledge_;
  Writes write_;
  std::vector<Question> questions_;
  std::vector<Change> changes_;      // that are over
  std::vector<Clearing> clearings_;  // of failures without a strategy of their own
};

}  // namespace culprit
