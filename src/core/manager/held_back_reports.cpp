#include "manager/held_back_reports.h"

#include <algorithm>
#include <utility>

namespace culprit {
namespace {

bool same_reasons(const std::vector<Candidate>& a, const std::vector<Candidate>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Candidate& x, const Candidate& y) {
                      return x.strategy == y.strategy && x.excluded == y.excluded &&
                             x.component == y.component && x.failure == y.failure;
                    });
}

}  // namespace

void HeldBackReports::held_back(const Decision& decision, Time failing_since, Time now,
                                EventLog& events) {
  auto& [since, said] = of_rules_[decision.rule.index];
  if (std::exchange(since, failing_since) != failing_since) said.clear();
  while (said.size() > 1 && later(said.front().at, kSaidAgain) <= now) said.erase(said.begin());
  const bool was_said = std::ranges::any_of(
      said, [&](const Said& each) { return same_reasons(each.candidates, decision.candidates); });
  if (was_said) return;
  said.push_back({now, decision.candidates});
  events.tell(now, FailureHeldBack{decision.rule, decision.candidates, decision.suspects});
}

}  // namespace culprit
