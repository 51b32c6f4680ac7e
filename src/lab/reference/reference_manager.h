// The managing system of the paper's authors, as their public code behaves, slips included.
//
// Source: github.com/XITASO/concurrent-uncertainty-resolving (October 2025), the code whose planner
// the paper describes; the version that the paper measured is not public. It is there for
// comparison: to see which of the published numbers come from the method and which from the code.
//
// It polls. Every CYCLE of the rules it evaluates all triggers, plans, and advances its requests;
// what is observed in between only changes its blackboard and its dependency graph. The CYCLE is a
// wall-clock period in the reference: where the robot's time runs at a fifth of it, 200 ms are 40
// ms here.
//
// The blackboard holds the signals of the rules, each with the value read last, for ever. Rates,
// ages and states are not there: a rule file for the reference reads signals only.
//
// It learns nothing: P stays the designer's.
//
// Not reproduced: the reference works on texts of numbers with six decimals (so 1e-7 == 0), and
// exits on errors in expressions at run time. It also shuts a component down by a lifecycle
// transition, which an inactive node refuses.
#pragma once

#include <memory>

#include "base/expected.h"
#include "knowledge/signal_store.h"
#include "manager/managing_system.h"
#include "reference/analysis.h"
#include "reference/execution.h"
#include "reference/graph.h"
#include "reference/options.h"
#include "reference/planning.h"

namespace culprit::study {

class ReferenceManager : public ManagingSystem {
 public:
  // An error if the rules use what the reference does not know, or a signal has no initial value.
  // `rules` must outlive the manager and keep its address.
  static Expected<std::unique_ptr<ReferenceManager>> make(const RuleSet& rules,
                                                          ReferenceOptions options);

  // Ticks at most once: a polling loop that comes late does not catch up.
  std::vector<Command> step(Time now, std::span<const Observation> observations) override;
  Time next_deadline() const override { return next_tick_; }
  std::span<const Event> events() const override { return events_; }

 private:
  ReferenceManager(const RuleSet& rules, const ReferenceOptions& options);
  void take_in(const Observation& observation, std::vector<Command>& commands);
  void write(SignalId signal, const Value& value);
  void tick(std::vector<Command>& commands);

  const RuleSet& rules_;
  Time start_;
  Time now_ = kLongAgo;
  Time next_tick_;
  SignalStore blackboard_;
  reference::Graph graph_;
  reference::Analysis analysis_;
  reference::Execution execution_;
  reference::Planning planning_;
  std::vector<StrategyId> chosen_;  // in the last tick
  std::vector<Event> events_;
};

}  // namespace culprit::study
