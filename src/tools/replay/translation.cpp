#include "replay/translation.h"

#include <algorithm>

namespace culprit::replay {
namespace {

struct Namer {
  const RuleSet& rules;
  std::string operator()(const Topic& topic) const {
    return topic.publisher ? topic.name + " FROM " + rules[*topic.publisher].name : topic.name;
  }
  std::string operator()(const Signal& signal) const { return signal.name; }
  std::string operator()(const StatusLevel& status) const { return status.name; }
  std::string operator()(const Component& component) const { return component.name; }
  std::string operator()(const Strategy& strategy) const {
    return rules[strategy.rule].name + " " + strategy.name;
  }
  std::string operator()(const Parameter& parameter) const {
    return rules[parameter.component].name + " " + parameter.name;
  }
};

// For each of `from` the one of the same name in `to`; the rest of `to` is missing.
template <class Id, class Thing>
std::vector<std::optional<Id>> match(const std::vector<Thing>& from, const Namer& name_from,
                                     const std::vector<Thing>& to, const Namer& name_to,
                                     const char* what, std::vector<std::string>& missing) {
  std::vector<std::optional<Id>> map(from.size());
  for (std::size_t t = 0; t < to.size(); ++t) {
    const std::string name = name_to(to[t]);
    const auto found = std::find_if(from.begin(), from.end(),
                                    [&](const Thing& thing) { return name_from(thing) == name; });
    if (found == from.end()) {
      missing.push_back(std::string(what) + " " + name);
    } else {
      map[static_cast<std::size_t>(found - from.begin())] = Id(t);
    }
  }
  return map;
}

}  // namespace

Translation::Translation(const RuleSet& from, const RuleSet& to) {
  const Namer ours{from};
  const Namer theirs{to};
  topics_ = match<TopicId>(from.topics, ours, to.topics, theirs, "topic", missing_);
  signals_ = match<SignalId>(from.signals, ours, to.signals, theirs, "signal", missing_);
  diagnostics_ = match<DiagnosticId>(from.diagnostics, ours, to.diagnostics, theirs,
                                     "level of diagnostic", missing_);
  parameters_ =
      match<ParameterId>(from.parameters, ours, to.parameters, theirs, "parameter", missing_);
  std::vector<std::string> new_components;  // the graph tells of them by name
  components_ =
      match<ComponentId>(from.components, ours, to.components, theirs, "component", new_components);
  std::vector<std::string> new_strategies;  // nothing of the recording is missing for them
  strategies_ =
      match<StrategyId>(from.strategies, ours, to.strategies, theirs, "strategy", new_strategies);
}

std::optional<Observation> Translation::operator()(const Observation& observation) const {
  Observation out = observation;
  const auto renumber = [](auto& id, const auto& map) {
    const auto mapped = map[id.index];
    if (mapped) id = *mapped;
    return mapped.has_value();
  };
  bool is_known = true;
  if (auto* sample = std::get_if<SampleArrived>(&out.what)) {
    is_known = renumber(sample->topic, topics_);
  } else if (auto* listener = std::get_if<ListenerKnown>(&out.what)) {
    is_known = renumber(listener->topic, topics_);
  } else if (auto* signal = std::get_if<SignalRead>(&out.what)) {
    is_known = renumber(signal->signal, signals_);
  } else if (auto* level = std::get_if<DiagnosticRead>(&out.what)) {
    is_known = renumber(level->diagnostic, diagnostics_);
  } else if (auto* parameter = std::get_if<ParameterRead>(&out.what)) {
    is_known = renumber(parameter->parameter, parameters_);
  } else if (auto* lifecycle = std::get_if<LifecycleRead>(&out.what)) {
    is_known = renumber(lifecycle->component, components_);
  } else if (auto* process = std::get_if<ProcessSeen>(&out.what)) {
    is_known = renumber(process->component, components_);
  } else if (auto* launcher = std::get_if<LauncherSeen>(&out.what)) {
    is_known = renumber(launcher->component, components_);
  } else if (auto* started = std::get_if<StartedHere>(&out.what)) {
    is_known = renumber(started->component, components_);
  } else if (auto* worked = std::get_if<ProcessWorked>(&out.what)) {
    is_known = renumber(worked->component, components_);
  } else if (auto* goals = std::get_if<GoalsSeen>(&out.what)) {
    is_known = renumber(goals->topic, topics_);
  } else if (auto* log = std::get_if<LogSeen>(&out.what)) {
    is_known = renumber(log->component, components_);
  } else if (auto* usage = std::get_if<UsageSeen>(&out.what)) {
    is_known = renumber(usage->component, components_);
  } else if (auto* reached = std::get_if<HostReached>(&out.what)) {
    is_known = renumber(reached->component, components_);
  } else if (auto* held = std::get_if<TimeHeld>(&out.what)) {
    is_known = renumber(held->component, components_);
  } else if (auto* barred = std::get_if<StartBarred>(&out.what)) {
    is_known = renumber(barred->component, components_);
  } else if (auto* unloaded = std::get_if<Unloaded>(&out.what)) {
    is_known = renumber(unloaded->component, components_);
  } else if (auto* lives = std::get_if<LivesOn>(&out.what)) {
    is_known = renumber(lives->component, components_);
  } else if (auto* ends = std::get_if<EndsWith>(&out.what)) {
    is_known = renumber(ends->component, components_);
    std::erase_if(ends->others, [&](ComponentId& each) { return !renumber(each, components_); });
  } else if (auto* probed = std::get_if<Probed>(&out.what)) {
    is_known = renumber(probed->component, components_);
  } else if (auto* told = std::get_if<PriorsTold>(&out.what)) {
    std::erase_if(told->priors, [&](auto& each) { return !renumber(each.strategy, strategies_); });
  } else if (std::holds_alternative<Reply>(out.what) || std::holds_alternative<Order>(out.what)) {
    is_known = false;
  }
  return is_known ? std::optional(std::move(out)) : std::nullopt;
}

}  // namespace culprit::replay
