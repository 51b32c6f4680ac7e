#include "torture/memory.h"

#include <algorithm>

namespace culprit::torture {
namespace {

// The rule whose strategy, if any, is over with this event.
std::optional<RuleId> ended_by(const Event& event, const RuleSet& rules) {
  if (const auto* e = std::get_if<FailureResolved>(&event.what)) return e->rule;
  if (const auto* e = std::get_if<FailureLost>(&event.what)) return e->rule;
  if (const auto* e = std::get_if<FailureHeldBack>(&event.what)) return e->rule;
  if (const auto* e = std::get_if<RoundSpent>(&event.what)) return e->rule;
  if (const auto* e = std::get_if<RuleExhausted>(&event.what)) return e->rule;
  if (const auto* e = std::get_if<StrategyAbandoned>(&event.what)) return rules[e->strategy].rule;
  if (const auto* e = std::get_if<OrderCarriedOut>(&event.what)) return rules[e->strategy].rule;
  return std::nullopt;
}

}  // namespace

void Memory::note(std::span<const Observation> observations, std::span<const Event> events,
                  std::span<const Command> commands) {
  for (const Observation& observation : observations) {
    if (const auto* reply = std::get_if<Reply>(&observation.what)) note(*reply);
  }
  for (const Event& event : events) note(event);
  for (const Command& command : commands) {
    if (!is_read(command)) note(command);
  }
}

void Memory::note(const Reply& reply) {
  for (Interrupted& each : open_) {
    // Numbers begin anew with each manager: the latest is meant.
    const auto request =
        std::find_if(each.requests.rbegin(), each.requests.rend(),
                     [&](const Interrupted::Request& r) { return r.command.id == reply.command; });
    if (request != each.requests.rend() && !request->outcome) request->outcome = reply.outcome;
  }
}

void Memory::note(const Event& event) {
  past_.push_back(event);
  if (const auto rule = ended_by(event, rules_)) return close(*rule);
  if (const auto* accepted = std::get_if<OrderAccepted>(&event.what)) {
    if (const auto* run = std::get_if<RunStrategy>(&accepted->order.what))
      close(rules_[run->strategy].rule);
  }
  if (const auto* chosen = std::get_if<StrategyChosen>(&event.what)) {
    if (chosen->dry_run || rules_[chosen->strategy].is_last_resort) return;
    close(rules_[chosen->strategy].rule);
    open_.emplace_back().strategy = chosen->strategy;
  } else if (const auto* done = std::get_if<AdaptationDone>(&event.what)) {
    if (Interrupted* each = open(done->strategy)) ++each->adaptations_done;
  } else if (const auto* failed = std::get_if<StrategyFailed>(&event.what)) {
    if (Interrupted* each = open(failed->strategy)) each->has_failed = true;
  }
}

void Memory::note(const Command& command) {
  if (rules_[command.purpose.strategy].is_last_resort) return;
  Interrupted* each = open(command.purpose.strategy);
  // It gives back what a strategy that is over owes, and the next manager owes that, too.
  if (each == nullptr && command.purpose.undoes) return;
  // A person may have ordered it: then no plan chose it.
  if (each == nullptr) {
    close(rules_[command.purpose.strategy].rule);
    each = &open_.emplace_back();
    each->strategy = command.purpose.strategy;
  }
  each->requests.push_back({command, std::nullopt});
}

Interrupted* Memory::open(StrategyId strategy) {
  const auto found = std::find_if(open_.begin(), open_.end(), [&](const Interrupted& each) {
    return each.strategy == strategy;
  });
  return found == open_.end() ? nullptr : &*found;
}

void Memory::close(RuleId rule) {
  std::erase_if(open_, [&](const Interrupted& each) { return rules_[each.strategy].rule == rule; });
}

std::vector<Interrupted> Memory::interrupted() const {
  std::vector<Interrupted> begun;
  for (const Interrupted& each : open_) {
    if (!each.requests.empty()) begun.push_back(each);
  }
  return begun;
}

}  // namespace culprit::torture
