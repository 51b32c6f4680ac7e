// Which outcomes can have two causes.
#pragma once

#include <vector>

#include "knowledge/attempts.h"
#include "knowledge/knowledge.h"

namespace culprit {

// The components where a failure can be cleared: those that its rule touches, and all their
// dependencies. The graph is searched once.
class Sources {
 public:
  Sources(const Knowledge& knowledge, RuleId rule);
  // Is one of these components among them?
  bool have(const std::vector<ComponentId>& adapted) const;

 private:
  std::vector<bool> is_source_;  // by component
};

// The inverse: the failures that adapting some components can clear. One search serves many rules.
class Effects {
 public:
  Effects(const Knowledge& knowledge, const std::vector<ComponentId>& adapted);
  bool reach(const Rule& rule) const;

 private:
  std::vector<bool> is_reached_;  // by component
};

// Can adapting these components clear the failure of `rule`?
bool can_resolve(const Knowledge& knowledge, const std::vector<ComponentId>& adapted, RuleId rule);

// Does the strategy restart, replace, start or stop anything?
bool begins_anew(const Strategy& strategy);

// Can `strategy`, which is of another rule, do so? It adapts a place from where that failure may
// come, and does more there than reconfigure it for the sake of something less critical. `sources`
// are the rule's, or `effects` the strategy's.
bool is_rival(const Knowledge& knowledge, StrategyId strategy, const Sources& sources, RuleId rule);
bool is_rival(const Knowledge& knowledge, StrategyId strategy, const Effects& effects, RuleId rule);

// May the failure of `other` have brought that of `rule` back? It is as critical, and touches what
// stands upstream.
bool may_bring_back(const Knowledge& knowledge, RuleId other, RuleId rule);

// May the failure of `other` hide whether that of `rule` is still there? It is more critical, and
// one of them is upstream of the other.
bool may_hide(const Knowledge& knowledge, RuleId other, RuleId rule);

// Is there a failure now that may hide that of `rule`?
bool is_hidden(const Knowledge& knowledge, RuleId rule);

// `changed`, which is under way, begins to change the system. Marks every attempt whose
// outcome it can cause, and its own if another one's changes can cause that: those that touch the
// same components or are upstream of them.
void mark_ambiguous(const Knowledge& knowledge, StrategyId changed, Attempts& attempts,
                    PendingOutcomes& outcomes);

// `strategy` begins to change the system `at` that time. Voids the verdicts on strategies of other
// rules whose deadline is yet to come and whose outcome it can cause: had one of these not helped
// so soon, it would still be under way, and ambiguous.
void void_verdicts_beside(const Knowledge& knowledge, StrategyId strategy, Time at,
                          PendingOutcomes& outcomes);

}  // namespace culprit
