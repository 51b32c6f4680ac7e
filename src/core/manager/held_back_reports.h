// Why failures are held back, as it is reported (FailureHeldBack): each reason once for each failure.
//
// Two reasons may hold by turns. A reason that was told within kSaidAgain is not told again, nor is the one that
// was told last. A failure that was repaired and is back is told of anew.
#pragma once

#include <vector>

#include "knowledge/event_log.h"
#include "plan/planner.h"

namespace culprit {

class HeldBackReports {
 public:
  static constexpr Duration kSaidAgain = std::chrono::seconds(5);

  explicit HeldBackReports(std::size_t rules) : of_rules_(rules) {}

  // The decision, about a failure that is there since `failing_since`, begins nothing now.
  void held_back(const Decision& decision, Time failing_since, Time now, EventLog& events);
  // Something is done about the failure.
  void went_on(RuleId rule) { of_rules_[rule.index] = {}; }

 private:
  struct Said {
    Time at{};
    std::vector<Candidate> candidates;
  };
  struct OfRule {
    Time failing_since = kNever;
    std::vector<Said> said;  // within the last kSaidAgain, and the last one
  };
  std::vector<OfRule> of_rules_;
};

}  // namespace culprit
