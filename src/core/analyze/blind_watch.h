// Finds the rules that are blind: their trigger has no value, so culprit cannot tell whether
// their failure is present (knowledge/blindness.h).
//
//   blind      The trigger has had no value for the debounce time. A trigger that other inputs
//              decide can see. So can one that is true, and one of which a known death decides. The
//              time counts from the end of discovery at the earliest, and while a strategy of the
//              rule is pending verification the rule is not called blind.
//   debounce   kDebounce; or the longest STALE, usual pause or window of the inputs without a value,
//              if that is longer. A window counts where samples come and do not cover it yet.
//   old value  knowledge/old_value.h
//   sees       The trigger has had a value again for kDebounce. The time doubles with each
//              recurrence, up to kLongestProof, so that an input that comes and goes reports few
//              events. The rule stays blind meanwhile. kProven without recurrence begins anew.
#pragma once

#include <chrono>
#include <optional>
#include <vector>

#include "knowledge/deadlines.h"
#include "knowledge/knowledge.h"

namespace culprit {

class BlindWatch {
 public:
  static constexpr Duration kDebounce = std::chrono::seconds(5);
  static constexpr Duration kLongestProof = std::chrono::minutes(5);
  static constexpr Duration kProven = std::chrono::minutes(10);

  // What it writes; all else it only reads.
  struct Writes {
    Blindness& blindness;
    EventLog& events;
  };

  // `knowledge` must outlive the watch. Watching begins at `start`; until `discovered` no rule is
  // called blind.
  BlindWatch(const Knowledge& knowledge, Writes writes, Time start, Time discovered);

  // The trigger of `rule` was evaluated.
  void evaluated(RuleId rule, Time now);

  // culprit did not listen until `now`: no pause from before counts.
  void restart(Time now);

  // Looks at the rules whose time has come.
  void advance(Time now);
  Time next_deadline() const { return deadlines_.next(); }

 private:
  struct Sight {
    bool was_known = false;       // the trigger, when it was evaluated last
    Time lost = kLongAgo;         // since when it has no value that counts; kNever: it has one
    Time regained = kNever;       // of a blind rule: since when it has one again
    Time proven_from = kLongAgo;  // when it was last called seeing
    int times = 0;                // it became blind, since it was proven to see
  };

  void look_at(RuleId id, Time now);
  void look_at_seeing(RuleId id, Time now);
  void look_at_unseeing(RuleId id, Time now);
  bool can_see(RuleId id) const;
  std::optional<Unseen> why_unseen(InputId id, Time now) const;
  std::optional<Unseen> why_without_value(InputId id, Time now) const;
  Duration debounce(RuleId id, Time now) const;
  Duration proof(const Sight& sight) const;
  Blind blind(RuleId id, Time now) const;
  Time next_look_at_old(RuleId id, Time now) const;

  const Knowledge& knowledge_;
  Writes write_;
  Time judged_from_;  // the end of discovery, or when the robot could be heard again
  Time heard_from_;   // no pause counts from before
  std::vector<Sight> sights_;
  std::vector<std::vector<InputId>> may_be_old_;  // by rule: inputs that keep their last value
  Deadlines deadlines_;                           // by RuleId
};

}  // namespace culprit
