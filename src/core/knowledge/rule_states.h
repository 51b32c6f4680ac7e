// Where each rule stands: quiet -> failing -> (attempting <-> failing) -> resolved (quiet again) |
// exhausted.
//
// And the health of components that follows from it. Health is a set: a component is as sick as the
// most critical failing rule that touches it, and one rule's recovery never wipes another's. An
// exhausted rule is none of these: culprit does nothing more about it. But while its trigger is
// true, its failure is still the cause of its effects, which wait for a person with it.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "base/time.h"
#include "knowledge/attempt.h"
#include "knowledge/onset.h"
#include "language/rule_set.h"

namespace culprit {

enum class RulePhase : std::uint8_t {
  kQuiet,
  kFailing,     // the failure is there, and no strategy is under way
  kAttempting,  // a strategy is under way, or is being undone
  kExhausted    // the failure is there, and nothing is left to try
};

// A failure is expected to clear with another one that was just resolved.
struct Settling {
  RuleId with;
  Time since = kNever;  // a fresh reading after this shows whether it did
  Time until = kNever;  // when the inputs of its trigger would have shown it
};

// How far the search for a strategy that helps has come.
struct Search {
  Search() = default;
  explicit Search(std::size_t strategies) : tried(strategies), ever_tried(strategies) {}

  int attempts = 0;              // strategies executed for the failure, also before it came back
  int attempts_before = 0;       // those of before it came back
  int times = 0;                 // the failure was detected, until it was proven gone
  int round = 0;                 // how often all strategies were gone through
  Time retry_at = kLongAgo;      // back-off after a round
  std::vector<bool> tried;       // in this round, by place in Rule::strategies
  std::vector<bool> ever_tried;  // likewise, in any round
  bool is_exhausted = false;     // nothing is left, until it is proven gone
  // A process that a strategy started, and that ends before this, was a try of the same attempt (READY).
  Time ready_until = kLongAgo;

  // The last resorts, which are no part of the rounds. `tried` means for each of them that it took
  // effect, or could not be carried out ATTEMPTS times.
  bool is_at_last_resort = false;  // the first of them is due, since nothing else helps in time
  Time last_resort_at = kLongAgo;  // the next of them is not begun before
  // Those that could not be carried out, so often in a row; tried again from `again` on, after ATTEMPTS
  // times only in a process that began after `begun`.
  struct Refused {
    StrategyId strategy;
    int times = 0;
    Time begun{};  // the last try
    Time again{};
  };
  std::vector<Refused> refused;
};

// The progress that an earlier process of culprit left.
struct LeftOff {
  Time since{};  // when the failure was detected
  Search search;
  std::optional<Time> gone;  // it cleared then, which is not proven yet
};

// The value of the rule's trigger, and how far its policies are satisfied.
struct Detection {
  Slot trigger;                   // as last evaluated
  Time trigger_since = kLongAgo;  // since when it has that value
  // When it last showed, by being false, that the function worked (analyze/seen_working.h). kLongAgo: never yet.
  Time last_false = kLongAgo;
  bool works = false;  // it was false when it was evaluated last, and showed that
  bool armed = true;   // ON_CHANGE: the trigger was not true since the rule acted

  // HOLD n/k: the last k evaluations, one per cycle, newest at `newest`.
  std::vector<bool> history;
  std::size_t newest = 0;
  int true_in_history = 0;
  Time sampled = kLongAgo;

  // The trigger is true although its inputs do not show it yet: their publisher is known to be down.
  // Empty: the inputs show it, or it is not true.
  struct KnownDeath {
    ComponentId component;
    Time since{};
  };
  std::optional<KnownDeath> known_death;
};

struct RuleState {
  RulePhase phase = RulePhase::kQuiet;
  Detection detection;
  Time failing_since = kNever;   // when the failure was detected
  std::optional<Onset> onset;    // when it began, as far as known when it was detected
  Time first_onset = kNever;     // the latest onset of its first detection, if it is flapping
  Time masked_until = kLongAgo;  // until then a failure upstream was there that may have caused it
  // When a strategy for it did not help last. It may have, and what shows since may have a cause that began meanwhile.
  Time unhelped_at = kLongAgo;
  Time worked_until = kLongAgo;   // when it was seen to be well last before that; kLongAgo: never
  Time recurring_since = kNever;  // if it cleared and is back: when it was detected first
  Time gone_since = kLongAgo;     // when it cleared last
  Time repaired = kLongAgo;       // when a strategy of its own cleared it last
  Time quiet_until = kLongAgo;    // COOLDOWN

  Search search;
  std::optional<Attempt> attempt;
  std::optional<Attempt> last_resort;  // of a last resort, beside that one
  // The last resorts that took effect for the failure, all or in part, and when. Their changes stay as
  // long as it is there.
  struct Standing {
    StrategyId strategy;
    Time since{};
    bool is_lost = false;  // a new process has not got them yet
  };
  std::vector<Standing> standing;
  bool stands(StrategyId strategy) const {
    return std::ranges::any_of(standing,
                               [&](const Standing& each) { return each.strategy == strategy; });
  }
  // The last attempt that failed, and when it took effect, if nothing else can have helped since.
  struct TriedAlone {
    StrategyId strategy;
    Time effective{};
  };
  std::optional<TriedAlone> tried_alone;
  // The attempt that made the trigger false, while a group that the rule is about is not active yet.
  std::optional<Attempt> cleared_by;
  bool is_advised = false;              // dry run: the decision was reported
  bool is_last_resort_advised = false;  // the same for the last resort
  std::optional<Settling> settling;
  std::optional<LeftOff> left_off;  // the failure was not seen to clear since

  // Since when the failure is there, with pauses or without.
  Time first_detected() const { return std::min(failing_since, recurring_since); }
};

class RuleStates {
 public:
  explicit RuleStates(const RuleSet& rules);
  // As `other` is, for `rules`: the same rules at another address.
  RuleStates(const RuleSet& rules, const RuleStates& other);

  const RuleSet& rules() const { return rules_; }
  const RuleState& operator[](RuleId id) const { return states_[id.index]; }
  // For everything but `phase`, which enter() changes. The analysis writes it; execution has verbs
  // for its part (attempts.h).
  RuleState& state(RuleId id) { return states_[id.index]; }

  // Where the strategy stands in Rule::strategies.
  std::size_t place_of(StrategyId id) const;
  // Was it tried in this round? In any round?
  bool is_tried(StrategyId id) const;
  bool was_ever_tried(StrategyId id) const;
  void set_tried(StrategyId id, bool tried);
  // Dry run: the decision about the failure was reported; or is to be reported anew.
  void advise(RuleId id) { states_[id.index].is_advised = true; }
  void advise_last_resort(RuleId id) { states_[id.index].is_last_resort_advised = true; }
  void advise_anew();
  // The failure is expected to clear with another one.
  void expect_to_settle(RuleId id, Settling settling) { states_[id.index].settling = settling; }
  // The search for a strategy begins: anew, or where an earlier process left off.
  void begin_search(RuleId id, Time now);
  // The failure is back before it was proven gone: the search goes on where it was.
  void go_on_searching(RuleId id, Time now);

  // Moves a rule to another phase and keeps the health of its components.
  void enter(RuleId id, RulePhase phase);

  bool is_active(RuleId id) const { return is_active(states_[id.index].phase); }
  // Is its failure there, as far as anybody can know? A strategy may be under way without one: a person ordered it, or it
  // is being undone.
  bool has_failure(RuleId id) const {
    const RuleState& state = states_[id.index];
    return state.phase != RulePhase::kQuiet && !(state.attempt && state.attempt->has_no_failure);
  }
  // Rules that are failing or attempting, ascending.
  const std::vector<RuleId>& active() const { return active_; }

  // Exhausted rules, ascending.
  const std::vector<RuleId>& exhausted() const { return exhausted_; }
  // Is the rule exhausted, and its failure there for sure?
  bool awaits_person(RuleId id) const;
  // A rule other than `except` that awaits a person, touches `component` and is at least as
  // critical as `level`; the most critical, the first by name among equals.
  std::optional<RuleId> awaiting_person_at(ComponentId component, Criticality level,
                                           RuleId except) const;

  // Is there a failing rule other than `except` that touches `component` and is at least as
  // critical as `level`?
  bool is_sick(ComponentId component, Criticality level, RuleId except) const;
  // The most critical such rule, the first by name among equals.
  std::optional<RuleId> sickness(ComponentId component, Criticality level, RuleId except) const;

  // The rules with a strategy that adapts it, ascending.
  std::span<const RuleId> touching(ComponentId component) const;

  // The attempt of the strategy, if it is under way.
  const Attempt* attempt_of(StrategyId id) const;
  // Where an attempt of the strategy has its place: its rule's, or that of the rule's last resorts.
  std::optional<Attempt>& slot_of(StrategyId id);

  // The strategy attempt that has `component` reserved, if any: from its choice until its verdict
  // and undoing, but while it is suspended. A last resort's, if there are several.
  const Attempt* reservation(ComponentId component) const;
  // Calls `visit(attempt)` for each of these: a last resort goes beside another strategy.
  template <class Visit>
  void for_each_reservation(ComponentId component, Visit visit) const {
    for (const RuleId id : touching(component)) {
      const RuleState& state = states_[id.index];
      if (reserves(state.last_resort, component)) visit(*state.last_resort);
      if (is_active(id) && reserves(state.attempt, component)) visit(*state.attempt);
    }
  }

  // The strategy sets a parameter that `by` had set, and the more critical failure that this had resolved
  // came back: the value of `by` stays.
  struct Bar {
    StrategyId by;
    Time since{};
  };
  const std::optional<Bar>& bar_of(StrategyId id) const { return bars_[id.index]; }
  void bar(StrategyId id, Bar bar) { bars_[id.index] = bar; }

  // Calls `visit(strategy)` for each last resort that took effect, or is under way, for a failure that is
  // still there.
  template <class Visit>
  void for_each_standing(Visit visit) const {
    for (const RuleId id : with_last_resort_) {
      const RuleState& state = states_[id.index];
      if (!is_active(state.phase) && state.phase != RulePhase::kExhausted) continue;
      for (const RuleState::Standing& each : state.standing) visit(each.strategy);
      if (state.last_resort) visit(state.last_resort->strategy);
    }
  }

 private:
  template <class Counts>
  std::optional<RuleId> worst_at(ComponentId component, Criticality level, RuleId except,
                                 Counts counts) const;
  void find_touching();
  bool reserves(const std::optional<Attempt>& attempt, ComponentId component) const;
  static bool is_active(RulePhase phase) {
    return phase == RulePhase::kFailing || phase == RulePhase::kAttempting;
  }
  const RuleSet& rules_;
  std::vector<RuleState> states_;
  std::vector<RuleId> active_;
  std::vector<RuleId> exhausted_;
  std::vector<RuleId> with_last_resort_;  // most robots have few
  std::vector<std::optional<Bar>> bars_;  // by strategy
  std::vector<std::array<int, 3>>
      failing_;  // by component, by criticality: how many active rules touch it
  // The rules that touch each component, ascending, one component after the other; and where those
  // of each begin, and the end.
  std::vector<RuleId> touching_;
  std::vector<std::size_t> first_touching_;
};

}  // namespace culprit
