// The reference's analysis: which rules fail, and how the strategies under way do.
//
// A rule is quiet, sent to planning, or adapted. In every tick
//   1. the counter of each adapted rule goes up by one;
//   2. each strategy that planning chose in the tick before is marked as tried, and its rule is
//      adapted, with a counter of minus its waiting time;
//   3. every trigger is evaluated, in file order:
//        true,  quiet                   detected: all strategies are untried, the health of every
//                                       component of every strategy is the rule's level; sent
//        true,  adapted, counter > 1    the strategy failed; sent, with what was tried
//        false, adapted, counter != 0   resolved by the strategy; all its components are healthy
//        false, sent                    resolved without a strategy; likewise
//
// So a strategy that is chosen in tick k and waits E fails in tick k + E + 3, and succeeds in the
// first tick whose trigger is false: the code compares a signed counter with an unsigned 1, which
// every negative one passes. A rule whose strategies all failed stays sent for as long as its
// trigger holds: nothing is tried again, and its components stay sick.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "knowledge/event.h"
#include "reference/options.h"
#include "reference/sent_rules.h"

namespace culprit::study::reference {

class Analysis {
 public:
  // `rules` must outlive the analysis.
  Analysis(const RuleSet& rules, const ReferenceOptions& options);

  // One tick. `chosen` is what planning chose in the tick before.
  void advance(Time now, std::span<const StrategyId> chosen, std::span<const Slot> signals,
               std::vector<Event>& events);

  // The rules that wait for planning.
  std::span<const RuleId> sent() const { return sent_.in_order(); }
  bool is_tried(StrategyId strategy) const { return tried_[strategy.index]; }
  // One for each component: a later rule overwrites it, and any resolved rule that touches the
  // component sets it to OK.
  Criticality health(ComponentId component) const { return healths_[component.index]; }

 private:
  enum class Phase : std::uint8_t { kQuiet, kSent, kAdapted };
  struct State {
    Phase phase = Phase::kQuiet;
    std::int64_t counter = 0;        // kAdapted
    std::optional<StrategyId> last;  // kAdapted: the one under way
    Time detected = kNever;
  };

  void look_at(RuleId id, bool triggered, Time now, std::vector<Event>& events);
  void detect(RuleId id, Time now, std::vector<Event>& events);
  void fail(RuleId id, Time now, std::vector<Event>& events);
  void resolve(RuleId id, FailureResolved::How how, Time now, std::vector<Event>& events);
  void set_health(RuleId id, Criticality health);

  const RuleSet& rules_;
  std::vector<State> states_;         // by rule
  std::vector<bool> tried_;           // by strategy
  std::vector<Criticality> healths_;  // by component
  SentRules sent_;
};

}  // namespace culprit::study::reference
