// Parts of the evaluation that may be varied: constants that neither the paper nor the exemplar's sources settle, and the
// rules.
#pragma once

#include <optional>
#include <string>

#include "exemplars/sunset/model/profile.h"
#include "language/rule_set.h"

namespace culprit::study {

struct Variation {
  std::optional<Duration> relaunch;           // until a launched node is in the graph
  std::optional<Duration> blackboard_period;  // between two outputs of SUNSET's monitoring
  std::optional<std::size_t> window;          // arrivals that its frequencies are taken over
  // Factor of the impact of restarts and redeployments, which is also how long they are given.
  double patience = 1;
  std::string rules{};  // the text of a rule file in place of the built-in rules; empty: those

  bool operator==(const Variation&) const = default;
};

sunset::model::Profile varied(sunset::model::Profile profile, const Variation& variation);
RuleSet varied(RuleSet rules, const Variation& variation);

}  // namespace culprit::study
