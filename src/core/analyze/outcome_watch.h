// From verdicts to beliefs: an outcome counts once it stood for long enough (knowledge/outcomes.h).
//
// An outcome counts for nothing if
//   - before the strategy's deadline something else could have had the same effect,
//   - a more critical failure that it is connected with is there at the deadline, or appears before
//     the outcome is due: it hides what the strategy did,
//   - a failure upstream appears before the outcome is due: a second fault is no evidence about the
//     strategy,
//   - culprit did not watch for a while before the outcome was due (it was suspended, or deaf),
//   - it is not known whether the failure is there when the outcome is due.
// The same questions are asked about strategies that helped and that did not, over the same time.
// If the failure came back by itself, the strategy did not help.
#pragma once

#include "knowledge/knowledge.h"

namespace culprit {

class OutcomeWatch {
 public:
  // What it writes; all else it only reads.
  struct Writes {
    Beliefs& beliefs;
    PendingOutcomes& outcomes;
    EventLog& events;
  };

  // `knowledge` must outlive the watch.
  OutcomeWatch(const Knowledge& knowledge, Writes writes) : knowledge_(knowledge), write_(writes) {}

  // The verdict on `attempt`, which began to change things before its failure went away by itself.
  void judged(const Attempt& attempt, bool has_helped, Time now);
  // A failure came, or came back.
  void detected(RuleId rule, Time now);
  // culprit did not watch for a while: outcomes of that time count for nothing.
  void restart();
  // A computer became unreachable: failures that it explains from now on are no evidence about
  // strategies.
  void host_fell_silent();
  // The outcomes that an earlier process waited for.
  void remember(const Event& event);

  void advance(Time now);
  Time next_deadline() const;

 private:
  void look_at(PendingOutcome& outcome);
  void count(const PendingOutcome& outcome, Time now);

  const Knowledge& knowledge_;
  Writes write_;
};

}  // namespace culprit
