// The reference's execution: chosen strategies become requests to the components.
//
// Adaptations wait at their component until the next round. A round runs all components side by
// side. In each, it works through the waiting adaptations in this order: redeploy (the first one;
// others are dropped), activate, deactivate and restart (the same), changes of communication (all),
// parameters (all, and once more all that were ever sent). A failure ends the component's part of the round. The next round begins in the
// tick after the slowest component is through: a request that is never answered holds back
// everything for good.
//
// A component is busy from a request to the tick that sees its answer. Its answer to the shutdown
// ends a redeploy: the new process is started in the background. The outcome of a request reaches
// no other part.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "knowledge/event.h"
#include "language/evaluate.h"
#include "robot/command.h"

namespace culprit::study::reference {

class Execution {
 public:
  // The reference waits without end. This is the time after which adapters report a timeout, which
  // is ignored.
  static constexpr Duration kNoTimeout = std::chrono::hours(24);

  // `rules` must outlive the execution.
  explicit Execution(const RuleSet& rules);

  // Has the strategy's adaptations wait at their components, with the values that they have now.
  void add(StrategyId strategy, std::span<const Slot> signals);

  // Takes an answer in, for the next tick to see. The second half of a restart follows at once: to
  // the reference it is one call.
  void answered(const Reply& reply, std::vector<Command>& commands);

  // One tick.
  void advance(Time now, std::vector<Command>& commands, std::vector<Event>& events);

  bool is_busy(ComponentId component) const { return branches_[component.index].is_busy; }

 private:
  enum class Stage : std::uint8_t { kRedeploy, kLifecycle, kCommunication, kParameters, kDone };
  struct Order {
    StrategyId strategy;
    std::size_t adaptation = 0;  // index in Strategy::adaptations
    Value value;                 // of the parameter
  };
  struct Call {
    CommandId id;
    std::optional<Transition> next;  // to ask for after it
    bool is_answered = false;
    bool has_succeeded = true;
  };
  // The adaptations of one component.
  struct Branch {
    std::vector<Order> waiting;
    Stage stage = Stage::kDone;  // in this round
    bool is_busy = false;
    std::vector<Order> orders;  // under way
    std::vector<Call> calls;
    std::vector<SetParameter> parameters;  // that were ever sent
  };

  const Adaptation& adaptation(const Order& order) const;
  Stage stage_of(const Order& order) const;
  static Stage after(Stage stage);
  void advance(ComponentId component, Time now, std::vector<Command>& commands,
               std::vector<Event>& events);
  void begin(Branch& branch, ComponentId component, std::vector<Command>& commands);
  void request(Branch& branch, ComponentId component, std::vector<Command>& commands);
  void finish(Branch& branch, ComponentId component, Time now, std::vector<Command>& commands,
              std::vector<Event>& events);
  CommandId send(ComponentId component, decltype(Command::what) what,
                 std::vector<Command>& commands);

  const RuleSet& rules_;
  std::vector<Branch> branches_;  // by component
  bool is_round_open_ = false;
  std::uint64_t last_command_ = 0;
};

}  // namespace culprit::study::reference
