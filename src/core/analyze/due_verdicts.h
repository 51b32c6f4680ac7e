// When the verdict on a strategy under way is due, and which it is (paper, "Analyzing").
//
// A strategy succeeds when its failure is resolved, once its adaptations took effect. It fails at
// its deadline: its impact in cycles after they took effect, plus the latency of what the trigger
// reads. The latency of a signal is two of its periods, so that a fresh reading comes first; five
// seconds while its period is not known. After a start or restart, the deadline allows for discovery
// of the publishers that the component reads, and of its subscribers (kInputs at most).
//
//   kNotYet    before the deadline; while its failure clears; while it is unknown whether the
//              failure is there (kLostAfter at most); while a more critical strategy has its components
//   kSucceeds  the failure has cleared, and the group is active that the strategy is about; with
//              ON_CHANGE as soon as the adaptations took effect
//   kFails     all else
//
// It also says what may excuse a strategy that did not help: an unreachable computer, and a start
// that cannot happen. It writes nothing: the analyzer acts (analyzer.h).
#pragma once

#include <optional>

#include "analyze/detector.h"
#include "knowledge/knowledge.h"

namespace culprit {

class DueVerdicts {
 public:
  // A failing rule whose trigger is unknown for longer is no longer called failing: whether it is
  // cannot be known.
  static constexpr Duration kLostAfter = std::chrono::seconds(30);
  // The longest time that a verdict on a started component waits for its inputs.
  static constexpr Duration kInputs = std::chrono::seconds(14);

  enum class Verdict : std::uint8_t { kNotYet, kSucceeds, kFails };

  // Both must outlive it.
  DueVerdicts(const Knowledge& knowledge, const Detector& detector)
      : knowledge_(knowledge), detector_(detector) {}

  // The deadline of an attempt whose adaptations took effect. It moves when it becomes known how long a signal
  // takes to show a change.
  Time deadline(const Attempt& attempt) const;
  // Has something come of all that it started, as far as the rule reads that?
  bool has_spoken(const Attempt& attempt) const;
  // @pre its deadline is set
  Verdict verdict(const Attempt& attempt, Time now) const;
  // When it may become another one although nothing that the rule reads changes; kNever: not at all.
  Time next(const Attempt& attempt, Time now) const;

  // A group that the rule is about and that is not active; nothing: there is none.
  std::optional<GroupId> missing_group(RuleId id, Time now) const;
  // Does nobody else reserve the components of a suspended attempt any more?
  bool has_components_back(const Attempt& attempt) const;
  // Was the failure gone before the attempt had changed anything?
  bool went_away_before(const Attempt& attempt) const;
  // The component on an unreachable computer that the attempt adapts, or that explains its failure.
  std::optional<ComponentId> unheard_behind(const Attempt& attempt) const;
  // Something that a start needs is missing; or what it has started is inactive, as it was before.
  std::optional<std::string> why_no_attempt(const Attempt& attempt) const;

 private:
  bool has_lost_a_process(const Attempt& attempt) const;
  bool is_about_whole_group(StrategyId strategy) const;
  // The group stays as it is, and that is not active: no member is changing.
  bool is_left_down(GroupId group, const Attempt& attempt, Time now) const;
  // Its effect cannot be seen before.
  Time shows_from(const Attempt& attempt) const;
  bool is_silent_since_its_start(ComponentId component, RuleId rule) const;
  // Is there a more critical failure for which the same component would be adapted?
  bool holds_up_more_critical(StrategyId strategy) const;
  const Slot& trigger_of(const Attempt& attempt) const;

  const Knowledge& knowledge_;
  const Detector& detector_;
};

}  // namespace culprit
