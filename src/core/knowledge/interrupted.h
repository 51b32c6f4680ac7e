// A strategy that an earlier process of culprit began and did not finish: its known progress, and
// the data that are needed to finish it (execute/resumption.h).
#pragma once

#include <optional>
#include <vector>

#include "robot/command.h"

namespace culprit {

struct Interrupted {
  // A request that changes something. It went out, or was about to.
  struct Request {
    Command command;
    std::optional<Outcome> outcome;  // empty: it is not known how it ended
  };

  StrategyId strategy;
  std::size_t adaptations_done = 0;  // proven by reading back
  bool has_failed = false;           // it did not help; what it had changed was being undone
  std::vector<Request> requests;     // in order, never empty
};

}  // namespace culprit
