// Verdicts that do not count yet, and how long they have to stand.
//
// A failure that clears for a second is not repaired. So a verdict is learned from only once the
// time is over in which an unrepaired failure comes back: `healthy` (--healthy) after the
// strategy's deadline. A strategy that failed waits as long as one that helped, and the same
// questions are asked about both. Otherwise the credit would depend on the outcome, and the beliefs
// would miss the true rates for good.
#pragma once

#include <vector>

#include "base/ids.h"
#include "base/time.h"

namespace culprit {

struct PendingOutcome {
  StrategyId strategy;
  bool has_helped = false;  // as the verdict says
  Time judged;              // when the verdict came
  Time due;                 // when it counts: `healthy` after the strategy's deadline
  // Something else can have had the same effect, or hidden it: it proves nothing.
  bool is_void = false;
  bool is_back = false;        // the failure came back
  bool was_looked_at = false;  // at the deadline: is anything there that hides it?
};

struct PendingOutcomes {
  std::vector<PendingOutcome> open;  // oldest first
  Duration healthy{};  // how long a failure has to stay away until it is proven to be gone

  // Of the strategy: until then it would have been given time to help.
  Time deadline(const PendingOutcome& outcome) const { return outcome.due - healthy; }
};

}  // namespace culprit
