#include "recorder/graph_json.h"

#include "json/json.h"

namespace culprit::recorder {

std::string graph_to_json(const ros2::Graph& graph) {
  Json nodes = Json::array();
  for (const auto& [node, endpoints, participant] : graph.nodes()) {
    Json json{{"name", node.name}};
    if (!node.host.empty()) json["host"] = node.host;
    if (node.pid != 0) json["process"] = node.pid;
    for (const char* list : {"publishes", "subscribes", "serves", "calls"})
      json[list] = Json::object();
    for (const ros2::GraphEndpoint& endpoint : endpoints) {
      const char* list = endpoint.kind == EndpointKind::kPublisher    ? "publishes"
                         : endpoint.kind == EndpointKind::kSubscriber ? "subscribes"
                         : endpoint.kind == EndpointKind::kServer     ? "serves"
                                                                      : "calls";
      json[list][endpoint.name] = endpoint.type;
    }
    nodes.push_back(std::move(json));
  }
  return to_line({{"nodes", nodes}});
}

}  // namespace culprit::recorder
