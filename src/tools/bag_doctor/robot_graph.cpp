#include "bag_doctor/robot_graph.h"

#include <algorithm>

#include "base/tool_names.h"
#include "json/json.h"
#include "knowledge/component_states.h"
#include "robot/component_binding.h"

namespace culprit::bag_doctor {
namespace {

std::string text_in(const Json& object, const char* member) {
  const auto found = object.find(member);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

const Json& list_in(const Json& object, const char* member) {
  static const Json none = Json::array();
  const auto found = object.find(member);
  return found != object.end() && found->is_array() ? *found : none;
}

void read_node(const Json& entry, RobotGraph& graph,
               std::map<std::string, std::set<std::string>>& servers,
               std::map<std::string, std::set<std::string>>& clients) {
  const std::string name = entry.is_object() ? text_in(entry, "name") : "";
  if (name.empty()) return;
  graph.nodes.insert(name);
  const auto read = [&](const char* member, std::map<std::string, std::set<std::string>>& into) {
    for (const Json& each : list_in(entry, member)) {
      if (each.is_string()) into[each.get<std::string>()].insert(name);
    }
  };
  read("publishes", graph.publishers);
  read("subscribes", graph.subscribers);
  read("serves", servers);
  read("calls", clients);
}

}  // namespace

bool RobotGraph::has_edges() const {
  return !edges.empty() || std::ranges::any_of(publishers, [&](const auto& each) {
    return subscribers.contains(each.first);
  });
}

void RobotGraph::add(const RobotGraph& other) {
  nodes.insert(other.nodes.begin(), other.nodes.end());
  edges.insert(other.edges.begin(), other.edges.end());
  for (const auto& [topic, some] : other.publishers)
    publishers[topic].insert(some.begin(), some.end());
  for (const auto& [topic, some] : other.subscribers)
    subscribers[topic].insert(some.begin(), some.end());
}

Expected<RobotGraph> parse_graph(std::string_view text) {
  const Json document = parse_json(text);
  if (!document.is_object() || !document.contains("nodes") || !document["nodes"].is_array())
    return Error{"it has no list of nodes; culprit graph --json writes one"};
  RobotGraph graph;
  std::map<std::string, std::set<std::string>> servers, clients;
  for (const Json& each : document["nodes"]) read_node(each, graph, servers, clients);
  for (const auto& [service, callers] : clients) {
    for (const std::string& caller : callers) {
      for (const std::string& server : servers[service]) {
        if (caller != server) graph.edges.insert({caller, server, service});
      }
    }
  }
  for (const Json& each : list_in(document, "dependencies")) {
    if (!each.is_object()) continue;
    RobotGraph::Edge edge{text_in(each, "consumer"), text_in(each, "producer"),
                          text_in(each, "channel")};
    if (edge.consumer.empty() || edge.producer.empty()) continue;
    graph.nodes.insert({edge.consumer, edge.producer});
    graph.edges.insert(std::move(edge));
  }
  return graph;
}

RobotGraph graph_of(const RuleSet& rules) {
  RobotGraph graph;
  const ComponentBinding binding(rules);
  const auto node_of = [&](ComponentId component) {
    const std::string& declared = binding.node_of(component);
    return declared.empty() ? "/" + rules[component].name : declared;
  };
  for (std::size_t c = 0; c < rules.components.size(); ++c)
    graph.nodes.insert(node_of(ComponentId(c)));
  for (const auto& each : rules.dependencies)
    graph.edges.insert({node_of(each.consumer), node_of(each.producer), ""});
  for (const Topic& topic : rules.topics) {
    if (topic.publisher) graph.publishers[topic.name].insert(node_of(*topic.publisher));
  }
  // A rule that watches a topic and repairs one component says who publishes it, unless rules disagree.
  std::map<std::string, std::set<std::string>> repaired;
  for (const Rule& rule : rules.rules) {
    if (rule.components.size() != 1) continue;
    for (const InputId id : rule.inputs) {
      const Input& input = rules[id];
      if (input.kind == Input::Kind::kAge || input.kind == Input::Kind::kRate ||
          input.kind == Input::Kind::kPhi)
        repaired[rules[input.topic].name].insert(node_of(rule.components.front()));
    }
  }
  for (const auto& [topic, nodes] : repaired) {
    if (nodes.size() == 1 && !graph.publishers.contains(topic)) graph.publishers[topic] = nodes;
  }
  return graph;
}

std::string publisher_of(const std::string& topic, const RobotGraph& graph) {
  std::set<std::string> found;
  if (const auto known = graph.publishers.find(topic); known != graph.publishers.end())
    found = known->second;
  for (const RobotGraph::Edge& edge : graph.edges) {
    if (edge.channel == topic) found.insert(edge.producer);
  }
  std::erase_if(found, is_tool_node);
  if (found.size() == 1) return *found.begin();
  if (!found.empty()) return "";
  std::string best;
  for (const std::string& node : graph.nodes) {
    if (topic.starts_with(node + "/") && node.size() > best.size()) best = node;
  }
  return best;
}

}  // namespace culprit::bag_doctor
