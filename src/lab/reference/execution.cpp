#include "reference/execution.h"

#include <algorithm>

namespace culprit::study::reference {
namespace {

// The reference sends every number as a double.
Value as_sent(const Value& value) {
  const auto* whole = std::get_if<std::int64_t>(&value);
  return whole != nullptr ? Value(static_cast<double>(*whole)) : value;
}

}  // namespace

Execution::Execution(const RuleSet& rules) : rules_(rules), branches_(rules.components.size()) {}

const Adaptation& Execution::adaptation(const Order& order) const {
  return rules_[order.strategy].adaptations[order.adaptation];
}

Execution::Stage Execution::stage_of(const Order& order) const {
  switch (adaptation(order).type) {
    case AdaptationType::kRedeploy:
      return Stage::kRedeploy;
    case AdaptationType::kActivate:
    case AdaptationType::kDeactivate:
    case AdaptationType::kRestart:
      return Stage::kLifecycle;
    case AdaptationType::kChangeCommunication:
      return Stage::kCommunication;
    default:
      return Stage::kParameters;
  }
}

Execution::Stage Execution::after(Stage stage) {
  return static_cast<Stage>(static_cast<int>(stage) + 1);
}

void Execution::add(StrategyId strategy, std::span<const Slot> signals) {
  const auto& adaptations = rules_[strategy].adaptations;
  for (std::size_t a = 0; a < adaptations.size(); ++a) {
    Order order{strategy, a, adaptations[a].topic};
    // A value that does not exist (a division by zero) ends the reference's process. Here it is
    // only not sent.
    if (!adaptations[a].value.empty()) {
      const Slot value = evaluate(adaptations[a].value, signals);
      if (!value.known) continue;
      order.value = as_sent(to_value(value, adaptations[a].value.type));
    }
    branches_[adaptations[a].component.index].waiting.push_back(std::move(order));
  }
}

void Execution::answered(const Reply& reply, std::vector<Command>& commands) {
  // A component that does not answer is waited for.
  if (reply.outcome == Outcome::kTimedOut || reply.outcome == Outcome::kUnreachable) return;
  for (std::size_t c = 0; c < branches_.size(); ++c) {
    for (Call& call : branches_[c].calls) {
      if (call.id != reply.command) continue;
      call.has_succeeded &= reply.outcome == Outcome::kDone;
      call.is_answered = !call.next;
      if (call.next) call.id = send(ComponentId(c), ChangeLifecycle{*call.next}, commands);
      call.next.reset();
      return;
    }
  }
}

void Execution::advance(Time now, std::vector<Command>& commands, std::vector<Event>& events) {
  if (!is_round_open_) {
    for (Branch& branch : branches_) branch.stage = Stage::kRedeploy;
  }
  is_round_open_ = false;
  for (std::size_t c = 0; c < branches_.size(); ++c) {
    advance(ComponentId(c), now, commands, events);
    is_round_open_ |= branches_[c].stage != Stage::kDone;
  }
}

void Execution::advance(ComponentId component, Time now, std::vector<Command>& commands,
                        std::vector<Event>& events) {
  Branch& branch = branches_[component.index];
  while (branch.stage != Stage::kDone) {
    if (!branch.is_busy) {
      begin(branch, component, commands);
      if (branch.is_busy) return;
      continue;
    }
    if (!std::all_of(branch.calls.begin(), branch.calls.end(),
                     [](const Call& call) { return call.is_answered; }))
      return;
    finish(branch, component, now, commands, events);
  }
}

// Sends what waits for the present stage, or goes on to the next one.
void Execution::begin(Branch& branch, ComponentId component, std::vector<Command>& commands) {
  const auto of_stage =
      std::stable_partition(branch.waiting.begin(), branch.waiting.end(),
                            [&](const Order& order) { return stage_of(order) != branch.stage; });
  branch.orders.assign(of_stage, branch.waiting.end());
  branch.waiting.erase(of_stage, branch.waiting.end());
  if (branch.orders.empty()) {
    branch.stage = after(branch.stage);
    return;
  }
  const bool takes_one = branch.stage == Stage::kRedeploy || branch.stage == Stage::kLifecycle;
  if (takes_one) branch.orders.erase(branch.orders.begin() + 1, branch.orders.end());
  branch.is_busy = true;
  request(branch, component, commands);
}

void Execution::request(Branch& branch, ComponentId component, std::vector<Command>& commands) {
  const auto call = [&](decltype(Command::what) what, std::optional<Transition> next = {}) {
    branch.calls.push_back({send(component, std::move(what), commands), next});
  };
  const Adaptation& first = adaptation(branch.orders.front());
  switch (branch.stage) {
    case Stage::kRedeploy:
      return call(StopProcess{});
    case Stage::kLifecycle:
      if (first.type == AdaptationType::kActivate)
        return call(ChangeLifecycle{Transition::kActivate});
      if (first.type == AdaptationType::kDeactivate)
        return call(ChangeLifecycle{Transition::kDeactivate});
      return call(ChangeLifecycle{Transition::kDeactivate}, Transition::kActivate);
    case Stage::kCommunication:
      for (const Order& order : branch.orders)
        call(SetParameter{adaptation(order).subject, order.value});
      return;
    case Stage::kParameters:
      for (const Order& order : branch.orders)
        branch.parameters.push_back({adaptation(order).subject, order.value});
      for (const SetParameter& parameter : branch.parameters) call(parameter);
      return;
    case Stage::kDone:
      return;
  }
}

// All calls of the present stage are answered.
void Execution::finish(Branch& branch, ComponentId component, Time now,
                       std::vector<Command>& commands, std::vector<Event>& events) {
  const bool has_succeeded = std::all_of(branch.calls.begin(), branch.calls.end(),
                                         [](const Call& call) { return call.has_succeeded; });
  for (const Order& order : branch.orders) {
    if (has_succeeded) {
      events.push_back({now, AdaptationDone{order.strategy, order.adaptation, ""}});
    } else {
      events.push_back({now, AdaptationFailed{order.strategy, order.adaptation, "it refused"}});
    }
  }
  if (has_succeeded && branch.stage == Stage::kRedeploy) send(component, StartProcess{}, commands);
  branch.stage = has_succeeded ? after(branch.stage) : Stage::kDone;
  branch.is_busy = false;
  branch.calls.clear();
  branch.orders.clear();
}

CommandId Execution::send(ComponentId component, decltype(Command::what) what,
                          std::vector<Command>& commands) {
  commands.push_back({{++last_command_}, component, std::move(what), kNoTimeout});
  return commands.back().id;
}

}  // namespace culprit::study::reference
