#include "ros2/graph.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "base/ros_names.h"
#include "ros2/service_mapping.h"

namespace culprit::ros2 {
namespace {

// A node's reader of a topic is a subscriber, its reader of requests a server, and so on. The other
// halves of services (replies) say nothing new.
std::optional<GraphEndpoint> ros_meaning(const EndpointInfo& info) {
  auto channel = demangle_topic(info.topic);
  if (!channel || channel->channel == Channel::kReply) return std::nullopt;
  auto type = demangle_type(channel->channel, info.type);
  if (!type) return std::nullopt;
  const bool reads = info.guid.is_reader();
  EndpointKind kind = reads ? EndpointKind::kSubscriber : EndpointKind::kPublisher;
  if (channel->channel == Channel::kRequest)
    kind = reads ? EndpointKind::kServer : EndpointKind::kClient;
  return GraphEndpoint{kind,
                       std::move(channel->name),
                       std::move(*type),
                       info.qos,
                       std::string(user_data_value(info.user_data, "typehash")),
                       std::string(user_data_value(info.user_data, "sertypehash")),
                       info.partitions,
                       !user_data_value(info.user_data, "clientid").empty() ||
                           !user_data_value(info.user_data, "serviceid").empty()};
}

// Nothing when a name breaks the grammar.
std::optional<std::string> full_name(const NodeEntities& node) {
  if (!is_valid_namespace(node.name_space) || !is_valid_node_name(node.name)) return std::nullopt;
  return NodeName{node.name_space, node.name}.full();
}

std::string where(const GraphNode& node) {
  if (node.pid != 0) return "process " + std::to_string(node.pid);
  return node.host.empty() ? "an unknown process" : "a process on " + printable(node.host);
}

}  // namespace

Graph::Graph(Options options) : options_(std::move(options)) {}

void Graph::apply(const DiscoveryEvent& event) {
  struct Visitor {
    Graph& graph;
    void operator()(const ParticipantInfo& info) const { graph.add(info); }
    void operator()(const EndpointInfo& info) const { graph.add(info); }
    void operator()(const ParticipantGone& gone) const {
      graph.is_losing_ = gone.was_lost;
      graph.remove_participant(gone.guid.prefix());
      graph.is_losing_ = false;
    }
    void operator()(const EndpointGone& gone) const { graph.remove_endpoint(gone.guid); }
  };
  std::visit(Visitor{*this}, event);
}

void Graph::apply(const DiscoveryInfo& info, std::optional<GidSize> form) {
  const GuidPrefix prefix = info.participant.prefix();
  const auto found = peers_.find(prefix);
  if (found == peers_.end()) return;  // it has left, or there was no room for it
  Peer& peer = found->second;
  peer.form = form;
  looked_for_ = nullptr;
  const Claims before = std::exchange(peer.claims, {});
  for (const auto& [name, guids] : before) claim_count_ -= guids.size();
  Claims after = read_claims(info, peer);

  const auto is_claimed = [](const Claims& claims, const std::string& name, const Guid& guid) {
    const auto node = claims.find(name);
    return node != claims.end() && node->second.contains(guid);
  };
  for (const auto& [name, guids] : before) {
    for (const Guid& guid : guids) {
      const auto owner = owners_.find(guid);
      if (is_claimed(after, name, guid) || owner == owners_.end() || owner->second != name)
        continue;
      hide(guid);
      owners_.erase(owner);
    }
    if (!after.contains(name)) disclaim(prefix, name);
  }
  peer.claims = std::move(after);
  for (const auto& [name, guids] : peer.claims) {
    if (!before.contains(name)) claim(prefix, name);
    for (const Guid& guid : guids) {
      if (!is_claimed(before, name, guid) && owners_.emplace(guid, name).second) show(guid);
    }
  }
}

// What of `info` is well-formed and has room. @pre peer.claims is empty
Graph::Claims Graph::read_claims(const DiscoveryInfo& info, Peer& peer) {
  assert(peer.claims.empty());
  Claims claims;
  std::size_t new_nodes = 0;
  for (const NodeEntities& node : info.nodes) {
    const auto name = full_name(node);
    if (!name) {
      if (!std::exchange(peer.told_of_invalid_name, true)) {
        tell(GraphTrouble{"a node is left out because its name is not valid: namespace '" +
                          printable(node.name_space) + "', name '" + printable(node.name) + "'"});
      }
      continue;
    }
    if (claims.contains(*name) && !std::exchange(peer.told_of_duplicate, true)) {
      tell(GraphTrouble{"one process holds two nodes with the name " + *name});
    }
    if (!nodes_.contains(*name) && nodes_.size() + ++new_nodes > options_.limits.nodes) {
      warn_of_limit("nodes");
      break;
    }
    std::set<Guid>& endpoints = claims[*name];
    for (const auto* guids : {&node.readers, &node.writers}) {
      for (const Guid& guid : *guids) {
        if (guid.prefix() != info.participant.prefix())
          continue;  // nobody speaks for another participant
        if (!endpoints.contains(guid) && claim_count_ >= options_.limits.endpoints) {
          warn_of_limit("endpoints");
          return claims;
        }
        if (endpoints.insert(guid).second) ++claim_count_;
      }
    }
  }
  return claims;
}

void Graph::add(const ParticipantInfo& info) {
  const GuidPrefix prefix = info.guid.prefix();
  if (const auto known = peers_.find(prefix); known != peers_.end()) {
    known->second.info = info;
    return;
  }
  if (peers_.size() >= options_.limits.participants) return warn_of_limit("participants");
  peers_[prefix].info = info;
}

void Graph::add(const EndpointInfo& info) {
  const auto peer = peers_.find(info.guid.prefix());
  if (peer == peers_.end()) return;
  if (const Endpoint* known = find(info.guid); known != nullptr) {
    if (known->info.topic == info.topic && known->info.type == info.type)
      return;  // only its QoS or user data
    hide(info.guid);
  } else if (endpoint_count_ >= options_.limits.endpoints) {
    return warn_of_limit("endpoints");
  } else {
    ++endpoint_count_;
  }
  peer->second.endpoints.insert_or_assign(info.guid, Endpoint{info, ros_meaning(info)});
  show(info.guid);
}

void Graph::remove_participant(const GuidPrefix& prefix) {
  looked_for_ = nullptr;
  const auto found = peers_.find(prefix);
  if (found == peers_.end()) return;
  // As if it had said that it holds nothing, and then left.
  apply(DiscoveryInfo{found->second.info.guid, {}});
  endpoint_count_ -= found->second.endpoints.size();
  peers_.erase(found);
}

void Graph::forget_process(int pid) {
  std::vector<GuidPrefix> gone;
  for (const auto& [prefix, peer] : peers_) {
    if (peer.pid_is_known && peer.pid == pid && pid != 0) gone.push_back(prefix);
  }
  for (const GuidPrefix& prefix : gone) remove_participant(prefix);
}

void Graph::forget_ended_namesakes() {
  std::set<int> processes;
  std::set<GuidPrefix> unproven;
  for (const auto& [name, node] : nodes_) {
    if (node.claimants.size() < 2) continue;
    for (const GuidPrefix& claimant : node.claimants) {
      const Peer& peer = peers_.at(claimant);
      if (!has_ended(peer)) continue;
      if (peer.pid != 0) {
        processes.insert(peer.pid);
      } else {
        unproven.insert(claimant);
      }
    }
  }
  for (const int pid : processes) forget_process(pid);
  for (const GuidPrefix& prefix : unproven) remove_participant(prefix);
}

void Graph::remove_endpoint(const Guid& guid) {
  if (find(guid) == nullptr) return;
  hide(guid);
  peers_.at(guid.prefix()).endpoints.erase(guid);
  --endpoint_count_;
}

void Graph::claim(const GuidPrefix& prefix, const std::string& name) {
  Node& node = nodes_[name];
  node.claimants.push_back(prefix);
  if (node.told) {
    warn_of_duplicate(name, node);
    // First, so that its leaving is no loss; and again below, when more is known of who came.
    if (!has_ended(peers_.at(*node.told))) {
      count_namesakes(name, node);
      node.namesakes = -1;
    }
    tell_left(name, node);
  }
  tell_joined(name, node);
  count_namesakes(name, node);
}

void Graph::disclaim(const GuidPrefix& prefix, const std::string& name) {
  Node& node = nodes_.at(name);
  std::erase(node.claimants, prefix);
  if (node.told == prefix) tell_left(name, node);
  if (node.claimants.empty()) {
    nodes_.erase(name);
    return;
  }
  if (!node.told) tell_joined(name, node);
  count_namesakes(name, node);
}

void Graph::show(const Guid& guid) {
  Node* node = holder_of(guid);
  const Endpoint* endpoint = find(guid);
  if (node == nullptr || endpoint == nullptr || !endpoint->ros) return;
  const GraphEndpoint& ros = *endpoint->ros;
  Edge& edge = node->edges.try_emplace(EdgeKey{ros.kind, ros.name}, Edge{ros}).first->second;
  if (++edge.count == 1) tell(EndpointJoined{owners_.at(guid), ros});
}

void Graph::hide(const Guid& guid) {
  Node* node = holder_of(guid);
  const Endpoint* endpoint = find(guid);
  if (node == nullptr || endpoint == nullptr || !endpoint->ros) return;
  const GraphEndpoint& ros = *endpoint->ros;
  const auto edge = node->edges.find(EdgeKey{ros.kind, ros.name});
  if (--edge->second.count > 0) return;
  node->edges.erase(edge);
  tell(EndpointLeft{owners_.at(guid), ros.kind, ros.name});
}

// The node that claims the endpoint, if that participant's node of this name is the one that
// counts.
Graph::Node* Graph::holder_of(const Guid& guid) {
  const auto owner = owners_.find(guid);
  if (owner == owners_.end()) return nullptr;
  const auto node = nodes_.find(owner->second);
  return node != nodes_.end() && node->second.told == guid.prefix() ? &node->second : nullptr;
}

void Graph::tell_joined(const std::string& name, Node& node) {
  node.told = node.claimants.back();
  Peer& peer = peers_.at(*node.told);
  look_for_process(name, peer);
  tell(NodeJoined{describe(name, peer)});
  // Those that were known before: an older node of the name comes to count again.
  const auto claimed = peer.claims.find(name);
  if (claimed == peer.claims.end()) return;
  for (const Guid& guid : claimed->second) {
    if (const auto owner = owners_.find(guid); owner != owners_.end() && owner->second == name)
      show(guid);
  }
}

void Graph::tell_left(const std::string& name, Node& node) {
  for (const auto& [key, edge] : node.edges) tell(EndpointLeft{name, key.first, key.second});
  node.edges.clear();
  node.told.reset();
  tell(NodeLeft{name, is_losing_});
}

const Graph::Endpoint* Graph::find(const Guid& guid) const {
  const auto peer = peers_.find(guid.prefix());
  if (peer == peers_.end()) return nullptr;
  const auto endpoint = peer->second.endpoints.find(guid);
  return endpoint == peer->second.endpoints.end() ? nullptr : &endpoint->second;
}

int Graph::pid_of(Peer& peer) {
  if (!std::exchange(peer.pid_is_known, true) && options_.find_process)
    peer.pid = options_.find_process(peer.info).pid;
  return peer.pid;
}

bool Graph::has_ended(const Peer& peer) const {
  if (peer.pid != 0) return options_.is_running && !options_.is_running(peer.pid);
  return options_.find_process && options_.find_process(peer.info).has_ended;
}

// For a node that it comes to hold, of several at once for the first. Of an ended process nothing can be proven
// any more: what was known of it stays known.
void Graph::look_for_process(const std::string& name, Peer& peer) {
  const bool is_next = std::exchange(looked_for_, &peer) == &peer;
  if (!is_next && options_.find_process && (peer.pid == 0 || !has_ended(peer))) {
    FoundProcess found = options_.find_process(peer.info);
    peer.pid = found.pid;
    peer.pid_is_known = true;
    peer.missing = std::move(found.missing);
    if (peer.missing.empty()) peer.told_missing.clear();
  }
  tell_of_missing(name, peer);
}

// Once for all nodes of a process, by the first one that lacks it.
void Graph::tell_of_missing(const std::string& name, Peer& peer) {
  if (peer.missing == peer.told_missing) return;
  if (options_.is_ended_by_others && options_.is_ended_by_others(name)) return;
  tell(GraphTrouble{"the process of " + name +
                    " is not proven, so it is not ended: " + peer.missing});
  peer.told_missing = peer.missing;
}

GraphNode Graph::describe(const std::string& name, const Peer& peer) const {
  return {name, peer.info.vendor, peer.info.host, peer.pid};
}

// Hidden nodes are what people look with, and several may look at once.
void Graph::warn_of_duplicate(const std::string& name, const Node& node) {
  if (own_name(name).starts_with('_')) return;
  Peer& older = peers_.at(node.claimants[node.claimants.size() - 2]);
  Peer& newer = peers_.at(node.claimants.back());
  pid_of(older);
  if (has_ended(older)) return;  // a restart
  pid_of(newer);
  tell(GraphTrouble{"two nodes have the name " + name + ": one in " + where(describe(name, older)) +
                    ", one in " + where(describe(name, newer)) + "; the latter counts"});
}

// Told only when it changes. A predecessor whose lease still runs is none.
void Graph::count_namesakes(const std::string& name, Node& node) {
  std::vector<GraphNode> all;
  for (const GuidPrefix& claimant : node.claimants) {
    Peer& peer = peers_.at(claimant);
    if (claimant != node.told) pid_of(peer);
    const bool is_gone = claimant != node.told && has_ended(peer);
    if (!is_gone) all.push_back(describe(name, peer));
  }
  const int others = static_cast<int>(all.size()) - 1;
  if (std::exchange(node.namesakes, others) != others)
    tell(NodeNamesakes{name, others, std::move(all)});
}

void Graph::warn_of_limit(const char* what) {
  if (exceeded_.insert(what).second) {
    tell(GraphTrouble{std::string("there are too many ") + what +
                      " to keep track of; further ones are left out"});
  }
}

const ParticipantInfo* Graph::participant(const GuidPrefix& prefix) const {
  const auto found = peers_.find(prefix);
  return found == peers_.end() ? nullptr : &found->second.info;
}

int Graph::process_of(const GuidPrefix& prefix) const {
  const auto peer = peers_.find(prefix);
  return peer == peers_.end() ? 0 : peer->second.pid;
}

std::vector<std::pair<Guid, std::string>> Graph::publishers_of(const std::string& topic) const {
  std::vector<std::pair<Guid, std::string>> publishers;
  for (const auto& [guid, node] : owners_) {
    const Endpoint* found = find(guid);
    const bool is_it = found != nullptr && found->ros && found->ros->name == topic &&
                       found->ros->kind == EndpointKind::kPublisher;
    if (is_it) publishers.emplace_back(guid, node);
  }
  return publishers;
}

const EndpointInfo* Graph::endpoint(const Guid& guid) const {
  const Endpoint* found = find(guid);
  return found == nullptr ? nullptr : &found->info;
}

std::vector<Graph::NodeView> Graph::bare_nodes() const {
  std::vector<NodeView> views;
  views.reserve(nodes_.size());
  for (const auto& [name, node] : nodes_)
    views.push_back({describe(name, peers_.at(*node.told)), {}, *node.told});
  return views;
}

std::vector<Graph::NodeView> Graph::nodes() const {
  std::vector<NodeView> views = bare_nodes();
  for (NodeView& view : views) {
    const auto& edges = nodes_.at(view.node.name).edges;
    view.endpoints.reserve(edges.size());
    for (const auto& [key, edge] : edges) view.endpoints.push_back(edge.endpoint);
  }
  return views;
}

std::vector<Graph::ParticipantView> Graph::participants() const {
  std::vector<ParticipantView> views;
  for (const auto& [prefix, each] : peers_) {
    const Peer& peer = each;  // a lambda takes no part of a pair
    ParticipantView& view = views.emplace_back(ParticipantView{peer.info, peer.pid, peer.form});
    for (const auto& [name, guids] : peer.claims) {
      view.nodes.push_back(name);
      view.undiscovered += static_cast<std::size_t>(std::ranges::count_if(
          guids, [&](const Guid& guid) { return !peer.endpoints.contains(guid); }));
    }
    view.endpoints.reserve(peer.endpoints.size());
    for (const auto& [guid, endpoint] : peer.endpoints) {
      if (!endpoint.ros) continue;
      const auto owner = owners_.find(guid);
      view.endpoints.push_back({guid, owner == owners_.end() ? "" : owner->second, *endpoint.ros});
    }
    std::ranges::sort(view.endpoints, {}, &OwnedEndpoint::id);
  }
  std::ranges::sort(views, {}, [](const ParticipantView& view) { return view.info.guid; });
  return views;
}

void Graph::tell(const GraphChange& change) const {
  if (options_.listener) options_.listener(change);
}

}  // namespace culprit::ros2
