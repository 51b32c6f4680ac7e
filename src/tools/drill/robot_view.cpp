#include "drill/robot_view.h"

#include <algorithm>

#include "journal/json.h"

namespace culprit::drill {
namespace {

using journal::flag_of;
using journal::number_of;
using journal::text_of;

const Json& member(const Json& json, const char* key) {
  static const Json kNone = Json::array();
  const auto found = json.is_object() ? json.find(key) : json.end();
  return json.is_object() && found != json.end() && found->is_array() ? *found : kNone;
}

// Calls `each` with the same place of both lists.
void for_both(const Json& names, const Json& states, const auto& each) {
  for (std::size_t i = 0; i < std::min(names.size(), states.size()); ++i) {
    if (names[i].is_object() && states[i].is_object()) each(text_of(names[i], "name"), states[i]);
  }
}

std::optional<bool> trigger_of(const Json& state) {
  // A failing rule has no "trigger": it was true.
  if (!state.contains("trigger")) return true;
  if (!state["trigger"].is_boolean()) return std::nullopt;
  return state["trigger"].get<bool>();
}

}  // namespace

std::optional<bool> RobotView::trigger(const std::string& rule) const {
  std::optional<bool> out;
  for_both(member(robot_, "rules"), member(state_, "rules"),
           [&](const std::string& name, const Json& state) {
             if (name == rule) out = trigger_of(state);
           });
  return out;
}

std::vector<std::string> RobotView::complaints(const RobotView* healthy) const {
  std::vector<std::string> out;
  if (member(state_, "components").empty()) return {"nothing is known of the robot yet"};
  for_both(member(robot_, "rules"), member(state_, "rules"),
           [&](const std::string& name, const Json& state) {
             if (name.starts_with(kOwnRules)) return;
             const auto trigger = trigger_of(state);
             const bool may_be_blind = healthy == nullptr || !healthy->trigger(name);
             if (text_of(state, "phase") != "quiet") {
               out.push_back(name + " is " + text_of(state, "phase"));
             } else if (trigger.value_or(false)) {
               out.push_back("the trigger of " + name + " is true");
             } else if (!trigger && !may_be_blind) {
               out.push_back(name + " is blind");
             }
           });
  const auto before =
      healthy == nullptr ? std::map<std::string, Component>() : healthy->components();
  for_both(member(robot_, "components"), member(state_, "components"),
           [&](const std::string& name, const Json& state) {
             const auto known = before.find(name);
             if (known == before.end() ? healthy != nullptr : !known->second.is_alive) return;
             const std::string process = text_of(state, "process");
             if (!flag_of(state, "alive")) {
               out.push_back(name + " is not there");
             } else if (!process.empty() && process != "running") {
               out.push_back(name + " is " + process);
             } else if (state.contains("adapting")) {
               out.push_back(name + " is being adapted");
             }
           });
  return out;
}

std::map<std::string, RobotView::Component> RobotView::components() const {
  std::map<std::string, std::string> nodes;
  for (const Json& node : member(graph_, "nodes"))
    if (node.is_object()) nodes[text_of(node, "component")] = text_of(node, "node");
  std::map<std::string, Component> out;
  for_both(member(robot_, "components"), member(state_, "components"),
           [&](const std::string& name, const Json& state) {
             out[name] = {nodes[name], static_cast<int>(journal::integer_of(state, "pid")),
                          flag_of(state, "alive"), text_of(state, "lifecycle")};
           });
  return out;
}

std::vector<std::pair<std::string, std::string>> RobotView::edges() const {
  std::map<std::string, std::string> names;
  for (const auto& [name, component] : components())
    if (!component.node.empty()) names[component.node] = name;
  // A node that is no component stands for itself: dependencies may go through it.
  const auto name_of = [&](const std::string& node) {
    const auto found = names.find(node);
    return found == names.end() ? node : found->second;
  };
  std::vector<std::pair<std::string, std::string>> out;
  for (const Json& edge : member(graph_, "edges")) {
    if (edge.is_array() && edge.size() >= 2 && edge[0].is_string() && edge[1].is_string())
      out.emplace_back(name_of(edge[0].get<std::string>()), name_of(edge[1].get<std::string>()));
  }
  return out;
}

std::vector<std::string> RobotView::topics() const {
  std::vector<std::string> out;
  for (const Json& each : member(robot_, "topics"))
    if (each.is_string()) out.push_back(each.get<std::string>());
  return out;
}

HealthyRobot RobotView::healthy(const std::map<std::string, std::string>& publishers) const {
  HealthyRobot out;
  out.edges = edges();
  std::map<std::string, std::string> names;
  for (const auto& [name, component] : components()) {
    out.lifecycles[name] = component.lifecycle;
    if (!component.node.empty()) names[component.node] = name;
  }
  const Json& topics = member(robot_, "topics");
  const Json& states = member(state_, "topics");
  for (std::size_t i = 0; i < std::min(topics.size(), states.size()); ++i)
    if (topics[i].is_string())
      out.topics[topics[i].get<std::string>()].rate = number_of(states[i], "rate");
  for (const Json& edge : member(graph_, "edges")) {
    if (!edge.is_array() || edge.size() < 3 || !edge[2].is_string()) continue;
    const auto topic = out.topics.find(edge[2].get<std::string>());
    if (topic == out.topics.end()) continue;
    if (const auto consumer = names.find(edge[0].get<std::string>()); consumer != names.end())
      topic->second.subscribers.insert(consumer->second);
    if (const auto producer = names.find(edge[1].get<std::string>()); producer != names.end())
      topic->second.publisher = producer->second;
  }
  for (const auto& [topic, node] : publishers) {
    const auto found = out.topics.find(topic);
    const auto name = names.find(node);
    if (found != out.topics.end() && found->second.publisher.empty() && name != names.end())
      found->second.publisher = name->second;
  }
  return out;
}

std::set<std::string> RobotView::silent(const HealthyRobot& healthy) const {
  constexpr double kShortest = 0.3;  // seconds
  constexpr double kUsualGaps = 3;
  const Json& topics = member(robot_, "topics");
  const Json& states = member(state_, "topics");
  std::set<std::string> out;
  for (std::size_t i = 0; i < std::min(topics.size(), states.size()); ++i) {
    const auto usual = topics[i].is_string() ? healthy.topics.find(topics[i].get<std::string>())
                                             : healthy.topics.end();
    if (usual == healthy.topics.end()) continue;
    const HealthyRobot::Topic& topic = usual->second;
    if (!topic.publisher.empty() && topic.rate > 0 &&
        number_of(states[i], "age") > std::max(kShortest, kUsualGaps / topic.rate))
      out.insert(topic.publisher);
  }
  return out;
}

Json to_json(const HealthyRobot& robot) {
  Json json{{"edges", Json::array()}, {"lifecycles", Json::object()}, {"topics", Json::object()}};
  for (const auto& [consumer, producer] : robot.edges)
    json["edges"].push_back(Json::array({consumer, producer}));
  for (const auto& [component, state] : robot.lifecycles) json["lifecycles"][component] = state;
  for (const auto& [name, topic] : robot.topics)
    json["topics"][name] = {
        {"rate", topic.rate}, {"publisher", topic.publisher}, {"subscribers", topic.subscribers}};
  return json;
}

HealthyRobot healthy_from(const Json& json) {
  HealthyRobot out;
  for (const Json& edge : member(json, "edges")) {
    if (edge.is_array() && edge.size() == 2 && edge[0].is_string() && edge[1].is_string())
      out.edges.emplace_back(edge[0].get<std::string>(), edge[1].get<std::string>());
  }
  const auto each_of = [&](const char* key, const auto& each) {
    if (!json.is_object() || !json.contains(key) || !json[key].is_object()) return;
    for (const auto& [name, value] : json[key].items()) each(name, value);
  };
  each_of("lifecycles", [&](const std::string& name, const Json& state) {
    out.lifecycles[name] = state.is_string() ? state.get<std::string>() : "";
  });
  each_of("topics", [&](const std::string& name, const Json& value) {
    if (!value.is_object()) return;
    HealthyRobot::Topic& topic = out.topics[name];
    topic = {number_of(value, "rate"), text_of(value, "publisher"), {}};
    for (const Json& each : member(value, "subscribers"))
      if (each.is_string()) topic.subscribers.insert(each.get<std::string>());
  });
  return out;
}

}  // namespace culprit::drill
