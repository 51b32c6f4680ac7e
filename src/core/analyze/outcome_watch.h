// From verdicts to beliefs: an outcome counts once it stood for long enough (knowledge/outcomes.h).
//
// An outcome counts for nothing if
//   - before the strategy's deadline something else could have had the same effect,
//   - at the deadline a more critical failure that it is connected with is there, or one comes
//     before it is due: nobody sees through that,
//   - one upstream comes before it is due: a second fault blames nobody, and thanks nobody,
//   - nobody watched for a while before it was due (culprit slept, or was deaf),
//   - when it is due nobody can see whether the failure is there.
// All of that is asked in the same way of what helped and of what did not, and of the same time.
// If the failure is back by itself, the strategy did not help.
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
  // Nobody watched for a while: what came out meanwhile counts for nothing.
  void restart();
  // What an earlier process waited for.
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
