#include "web/watched_manager.h"

#include <algorithm>

#include "web/robot_json.h"

namespace culprit::web {
namespace {

bool may_change_graph(const Observation& observation) {
  const auto& what = observation.what;
  return std::holds_alternative<NodeAppeared>(what) || std::holds_alternative<NodeVanished>(what) ||
         std::holds_alternative<EndpointAppeared>(what) ||
         std::holds_alternative<EndpointVanished>(what) ||
         std::holds_alternative<ProcessSeen>(what);
}

}  // namespace

WatchedManager::WatchedManager(Manager& manager, Hub& hub, Metrics& metrics, Time start)
    : manager_(manager), hub_(hub), metrics_(metrics), start_(start) {
  metrics_.watch(manager_);
  hub_.publish(Kind::kRobot, to_line(rules_to_json(manager_.knowledge().rules)));
}

std::vector<Command> WatchedManager::step(Time now, std::span<const Observation> observations) {
  const auto begin = std::chrono::steady_clock::now();
  std::vector<Command> commands = manager_.step(now, observations);
  metrics_.stepped(std::chrono::steady_clock::now() - begin, observations.size(), manager_);
  tell_events();
  is_graph_new_ |= std::any_of(observations.begin(), observations.end(), may_change_graph);
  if (hub_.has_readers() && now >= next_tell_) tell_state(now);
  return commands;
}

Time WatchedManager::next_deadline() const {
  const Time own = manager_.next_deadline();
  return hub_.has_readers() ? std::min(own, next_tell_) : own;
}

void WatchedManager::tell_events() {
  const RuleSet& rules = manager_.knowledge().rules;
  for (const Event& event : manager_.events()) {
    Json json = to_json(event, rules, start_);
    if (!json["text"].get_ref<const std::string&>().empty())
      hub_.publish(Kind::kEvent, to_line(json));
  }
  if (!manager_.events().empty()) next_tell_ = later(told_, kSoon);
}

void WatchedManager::tell_state(Time now) {
  const Knowledge& knowledge = manager_.knowledge();
  if (is_graph_new_) {
    is_graph_new_ = false;
    hub_.publish(Kind::kGraph, to_line(graph_to_json(knowledge)));
  }
  std::string control = to_line(control_to_json(manager_, start_));
  if (control != told_control_) hub_.publish(Kind::kControl, told_control_ = std::move(control));
  Json state = state_to_json(knowledge, start_);
  if (remarks) add_remarks(state);
  hub_.publish(Kind::kState, to_line(state));
  told_ = now;
  next_tell_ = later(now, kPeriod);
}

void WatchedManager::add_remarks(Json& state) const {
  const Remarks all = remarks();
  const Knowledge& knowledge = manager_.knowledge();
  for (std::size_t c = 0; c < knowledge.rules.components.size() && !all.empty(); ++c) {
    const std::string& seen = knowledge.graph.node_name(ComponentId(c));
    const auto found = all.find(seen.empty() ? knowledge.rules.components[c].node : seen);
    if (found == all.end()) continue;
    Json& component = state["components"][c];
    const std::string own = component.value("remark", "");
    component["remark"] = own.empty() ? found->second : own + "; " + found->second;
  }
}

}  // namespace culprit::web
