// Whether a rule's trigger has held, or has stayed false, for as long as its policies ask (FOR,
// HOLD, COOLDOWN, ON_CHANGE).
//
// A topic whose publisher is known to be down is silent at once (known_silence.h). A trigger that is
// unknown neither holds nor is false.
#pragma once

#include "analyze/known_silence.h"
#include "analyze/seen_working.h"

namespace culprit {

inline bool is_true(const Slot& slot) { return slot.known && slot.b; }
inline bool is_false(const Slot& slot) { return slot.known && !slot.b; }

// How long a trigger has to hold at most until its failure is detected (FOR, HOLD).
Duration longest_detection(const RuleSet& rules);

class Detector {
 public:
  // Both must outlive it. It writes RuleState::detection alone.
  Detector(const Knowledge& knowledge, RuleStates& states)
      : knowledge_(knowledge),
        states_(states),
        known_silence_(knowledge),
        seen_working_(knowledge) {}

  // Evaluates the rule's trigger.
  void evaluate(RuleId id, Time now);
  // culprit did not watch until `now`: each time that must pass without a break begins anew.
  void restart(RuleId id, Time now);

  // Does the trigger of a quiet rule hold for long enough?
  bool detects(RuleId id, Time now) const;
  // Has it stayed false for long enough?
  bool is_cleared(RuleId id, Time now) const;
  // The event of a rule that detects.
  FailureDetected detected(RuleId id) const { return known_silence_.detected(id); }

  // When one of these can change next if nothing that the rule reads does; kNever: not at all.
  Time next(RuleId id, Time now) const;

 private:
  Slot value(RuleId id, Time now);
  void sample_history(Detection& detection, Time now) const;
  Duration clearing_time(RuleId id) const;

  const Knowledge& knowledge_;
  RuleStates& states_;
  KnownSilence known_silence_;
  SeenWorking seen_working_;
};

}  // namespace culprit
