// Gives an order to a running culprit, and waits for its outcome.
//
// It counts as done once the manager reports that it follows it. If it lasts (a pause, for example), it must also be on the disk, so that culprit keeps it
// across a restart. Any other outcome is a failure.
#pragma once

#include <string>
#include <vector>

#include "cli/running_culprit.h"

namespace culprit::cli {

struct OutcomeOfOrder {
  bool is_done = false;
  std::string text;       // what became of it
  Json answer = nullptr;  // of the call; null: there was none
};

// `order` is as POST /api/orders takes it, but for who gives it: that is who is at the terminal.
OutcomeOfOrder give(const RunningCulprit& culprit, Json order, const std::string& reason);

// An order to each of several, all at once. Outcomes in the order of `culprits`, which has as many as `orders`.
std::vector<OutcomeOfOrder> give_all(const std::vector<RunningCulprit>& culprits,
                                     std::vector<Json> orders, const std::string& reason);

}  // namespace culprit::cli
