#include "reference/graph.h"

namespace culprit::study::reference {
namespace {

EndpointKind reversed(EndpointKind kind) {
  if (kind == EndpointKind::kServer) return EndpointKind::kClient;
  return kind == EndpointKind::kClient ? EndpointKind::kServer : kind;
}

// The topic behind its node's namespace; a service as it is.
std::string channel(const std::string& node, EndpointKind kind, const std::string& name) {
  const bool is_topic = kind == EndpointKind::kPublisher || kind == EndpointKind::kSubscriber;
  return is_topic ? node.substr(0, node.rfind('/')) + name : name;
}

}  // namespace

Graph::Graph(const RuleSet& rules, const ReferenceOptions& options)
    : graph_(rules), frozen_at_(options.graph_frozen_at) {}

void Graph::take_in(const Observation& observation) {
  if (is_frozen_) return;
  if (const auto* node = std::get_if<NodeAppeared>(&observation.what)) {
    graph_.node_appeared(node->node);
  } else if (const auto* gone = std::get_if<NodeVanished>(&observation.what)) {
    graph_.node_vanished(gone->node);
  } else if (const auto* end = std::get_if<EndpointAppeared>(&observation.what)) {
    graph_.endpoint_appeared(end->node, reversed(end->kind),
                             channel(end->node, end->kind, end->name));
  } else if (const auto* lost = std::get_if<EndpointVanished>(&observation.what)) {
    graph_.endpoint_vanished(lost->node, reversed(lost->kind),
                             channel(lost->node, lost->kind, lost->name));
  }
}

void Graph::tick(Time now) { is_frozen_ |= now >= frozen_at_; }

}  // namespace culprit::study::reference
