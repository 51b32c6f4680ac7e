#include "web/hub_observer.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "ros2/context.h"
#include "rtps/origins.h"
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

double rounded_to_ms(double time) { return std::round(time * 1000) / 1000; }

}  // namespace

double HubObserver::wall_clock() {
  return seconds(std::chrono::system_clock::now().time_since_epoch());
}

void HubObserver::joined(ros2::NodeEntry& node) {
  metrics_.count_dropped(
      [&participant = node.context().participant()] { return participant.origins().dropped(); });
}

void HubObserver::leaves() { metrics_.count_dropped({}); }

void HubObserver::begins(const Manager& manager, std::function<Remarks()> remarks, Time start) {
  manager_ = &manager;
  remarks_ = std::move(remarks);
  start_ = start;
  told_ = next_tell_ = told_learned_ = kLongAgo;
  is_graph_new_ = true;
  told_control_.clear();
  metrics_.watch(manager);
  hub_.publish(http::Kind::kLearned, "{}");  // the old one counts by other rules
  hub_.publish(http::Kind::kRobot, to_line(rules_to_json(manager.knowledge().rules)));
}

void HubObserver::stepped(const Runtime::Step& step) {
  metrics_.stepped(step.took, step.observations.size(), *manager_);
  tell_events(step.events);
  is_graph_new_ |=
      std::any_of(step.observations.begin(), step.observations.end(), may_change_graph);
  if (hub_.has_readers() && step.now >= next_tell_) tell_state(step.now);
}

void HubObserver::announced(Time at, const EventWords& words, const std::string& text) {
  Json json{{"t", time_to_json(at, start_)}};
  json.update(to_json(words));
  json["text"] = text;
  tell_event(std::move(json));
}

void HubObserver::tell_event(Json json) {
  json["clock"] = rounded_to_ms(wall_());
  hub_.publish(http::Kind::kEvent, to_line(json));
}

void HubObserver::tell_events(std::span<const Event> events) {
  const RuleSet& rules = manager_->knowledge().rules;
  for (const Event& event : events) {
    Json json = to_json(event, rules, start_);
    // Incidents have no sentence: a page that looks back is made of them.
    const bool is_told = !json["text"].get_ref<const std::string&>().empty();
    if (is_told || json.contains("incident")) tell_event(std::move(json));
  }
  if (!events.empty()) next_tell_ = later(told_, kSoon);
}

void HubObserver::tell_state(Time now) {
  const Knowledge& knowledge = manager_->knowledge();
  if (is_graph_new_) {
    is_graph_new_ = false;
    hub_.publish(http::Kind::kGraph, to_line(graph_to_json(knowledge)));
  }
  std::string control = to_line(control_to_json(*manager_, start_));
  if (control != told_control_)
    hub_.publish(http::Kind::kControl, told_control_ = std::move(control));
  Json state = state_to_json(knowledge, start_);
  state["clock"] = rounded_to_ms(wall_());
  add_looks(*manager_, state);
  state["incidents"] = incidents_to_json(*manager_, start_);
  if (remarks_) add_remarks(state);
  if (now >= later(told_learned_, kLearnedPeriod)) {
    hub_.publish(http::Kind::kLearned, to_line(learned_to_json(knowledge)));
    told_learned_ = now;
  }
  hub_.publish(http::Kind::kState, to_line(state));
  told_ = now;
  next_tell_ = later(now, kPeriod);
}

void HubObserver::add_remarks(Json& state) const {
  const Remarks all = remarks_();
  const Knowledge& knowledge = manager_->knowledge();
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
