// Observations made for one rule file, as another one reads them: things that both name are the
// same.
#pragma once

#include <optional>
#include <vector>

#include "language/rule_set.h"
#include "robot/observation.h"

namespace culprit::replay {

class Translation {
 public:
  Translation(const RuleSet& from, const RuleSet& to);

  // Nothing where the other rules do not speak of it. Replies answer requests that the other
  // manager did not make, and orders were given about what the recorded one did: both go.
  std::optional<Observation> operator()(const Observation& observation) const;

  // What the other rules read and the recording does not have: "signal exposure", "topic /scan".
  const std::vector<std::string>& missing() const { return missing_; }

 private:
  template <class Id>
  using Map = std::vector<std::optional<Id>>;

  Map<TopicId> topics_;
  Map<SignalId> signals_;
  Map<DiagnosticId> diagnostics_;
  Map<ParameterId> parameters_;
  Map<ComponentId> components_;
  Map<StrategyId> strategies_;
  std::vector<std::string> missing_;
};

}  // namespace culprit::replay
