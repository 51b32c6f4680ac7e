#include "reference/reference_manager.h"

#include <algorithm>

#include "reference/unsupported.h"

namespace culprit::study {

Expected<std::unique_ptr<ReferenceManager>> ReferenceManager::make(const RuleSet& rules,
                                                                   ReferenceOptions options) {
  if (auto reason = reference::unsupported(rules, options)) return std::move(*reason);
  return std::unique_ptr<ReferenceManager>(new ReferenceManager(rules, options));
}

ReferenceManager::ReferenceManager(const RuleSet& rules, const ReferenceOptions& options)
    : rules_(rules),
      start_(options.start),
      next_tick_(options.start),
      blackboard_(rules),
      graph_(rules, options),
      analysis_(rules, options),
      execution_(rules),
      planning_(rules, options) {
  for (std::size_t s = 0; s < rules.signals.size(); ++s) {
    const auto value = options.initial.find(rules.signals[s].name);
    if (value != options.initial.end()) write(SignalId(s), value->second);
  }
}

std::vector<Command> ReferenceManager::step(Time now, std::span<const Observation> observations) {
  events_.clear();
  std::vector<Command> commands;
  now_ = std::max(now_, now);
  for (const Observation& observation : observations) take_in(observation, commands);
  if (now_ < next_tick_) return commands;
  tick(commands);
  next_tick_ = later(start_, rules_.cycle * ((now_ - start_) / rules_.cycle + 1));
  return commands;
}

void ReferenceManager::take_in(const Observation& observation, std::vector<Command>& commands) {
  if (const auto* read = std::get_if<SignalRead>(&observation.what)) {
    write(read->signal, read->value);
  } else if (const auto* reply = std::get_if<Reply>(&observation.what)) {
    execution_.answered(*reply, commands);
  } else {
    graph_.take_in(observation);
  }
}

// A value of a wrong type ends the reference's process. Here the one before stays.
void ReferenceManager::write(SignalId signal, const Value& value) {
  for (std::size_t i = 0; i < rules_.inputs.size(); ++i) {
    if (rules_.inputs[i].signal != signal) continue;
    std::string text;
    const Slot slot = as_type(value, rules_.inputs[i].type, text);
    if (slot.known) blackboard_.set_quietly(InputId(i), slot);
  }
}

void ReferenceManager::tick(std::vector<Command>& commands) {
  graph_.tick(now_);
  analysis_.advance(now_, chosen_, blackboard_.slots(), events_);
  chosen_ = planning_.advance(now_, analysis_, execution_, graph_, events_);
  for (const StrategyId strategy : chosen_) execution_.add(strategy, blackboard_.slots());
  execution_.advance(now_, commands, events_);
}

}  // namespace culprit::study
