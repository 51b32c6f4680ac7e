// From verdicts to beliefs: an outcome counts once it stood for long enough (knowledge/outcomes.h).
//
// An outcome counts for nothing if
//   - while the strategy was under way something else could have had the same effect
//   (is_ambiguous),
//   - a more critical failure that it is connected with is there, or comes before it is due: nobody
//     sees through that,
//   - the failure is back, and one upstream came as well: a second fault blames nobody,
//   - nobody watched for a while before it was due (culprit slept, or was deaf),
//   - when it is due nobody can see whether the failure is there.
// If the failure is back by itself, the strategy did not help.
#pragma once

#include "knowledge/knowledge.h"

namespace culprit {

class OutcomeWatch {
 public:
  // `knowledge` must outlive the watch.
  explicit OutcomeWatch(Knowledge& knowledge) : knowledge_(knowledge) {}

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
  void count(const PendingOutcome& outcome, Time now);

  Knowledge& knowledge_;
};

}  // namespace culprit
