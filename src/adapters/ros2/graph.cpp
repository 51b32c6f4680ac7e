#include "ros2/graph.h"

#include <algorithm>
#include <utility>

#include "base/invariant.h"
#include "base/ros_names.h"

namespace culprit::ros2 {
namespace {

// Gives nothing if a name breaks the grammar.
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
    void operator()(const rtps::EndpointInfo& info) const { graph.add(info); }
    void operator()(const ParticipantGone& gone) const {
      graph.is_losing_ = gone.was_lost;
      graph.remove_participant(gone.guid.prefix());
      graph.is_losing_ = false;
    }
    void operator()(const rtps::EndpointGone& gone) const { graph.remove_endpoint(gone.guid); }
  };
  std::visit(Visitor{*this}, event);
}

void Graph::apply(const DiscoveryInfo& info, std::optional<GidSize> form) {
  const rtps::GuidPrefix prefix = info.participant.prefix();
  const auto found = peers_.find(prefix);
  if (found == peers_.end()) return;  // it has left, or there was no room for it
  Peer& peer = found->second;
  peer.form = form;
  looked_for_ = nullptr;
  const Claims before = std::exchange(peer.claims, {});
  for (const auto& [name, guids] : before) claim_count_ -= guids.size();
  sources_[peer.source].names -= before.size();
  Claims after = read_claims(info, peer);
  keep_doubted(prefix, peer, before, after);
  sources_[peer.source].names += after.size();
  replace_claims(prefix, peer, before, std::move(after));
}

// A single message ends nothing that somebody acts on.
void Graph::keep_doubted(const rtps::GuidPrefix& prefix, Peer& peer, const Claims& before,
                         Claims& after) {
  if (!options_.is_asked_about) return;
  std::erase_if(peer.doubted, [&](const std::string& name) { return after.contains(name); });
  for (const auto& [name, guids] : before) {
    const auto node = nodes_.find(name);
    const bool counts = node != nodes_.end() && node->second.told == prefix;
    if (after.contains(name) || !counts || !options_.is_asked_about(name)) continue;
    after.emplace(name, guids);
    claim_count_ += guids.size();
    if (peer.doubted.insert(name).second) tell(NodeSaidToLeave{name});
  }
}

void Graph::believe_left(const std::string& name) {
  const auto node = nodes_.find(name);
  if (node == nodes_.end() || !node->second.told) return;
  const rtps::GuidPrefix prefix = *node->second.told;
  Peer& peer = peers_.at(prefix);
  if (peer.doubted.erase(name) == 0) return;  // it came back, or it is another one
  looked_for_ = nullptr;
  const Claims before = peer.claims;
  Claims after = before;
  claim_count_ -= after.at(name).size();
  after.erase(name);
  --sources_[peer.source].names;
  replace_claims(prefix, peer, before, std::move(after));
}

bool Graph::is_said_to_leave(const std::string& name) const {
  const auto node = nodes_.find(name);
  return node != nodes_.end() && node->second.told &&
         peers_.at(*node->second.told).doubted.contains(name);
}

void Graph::replace_claims(const rtps::GuidPrefix& prefix, Peer& peer, const Claims& before,
                           Claims after) {
  const auto is_claimed = [](const Claims& claims, const std::string& name,
                             const rtps::Guid& guid) {
    const auto node = claims.find(name);
    return node != claims.end() && node->second.contains(guid);
  };
  for (const auto& [name, guids] : before) {
    for (const rtps::Guid& guid : guids) {
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
    for (const rtps::Guid& guid : guids) {
      if (!is_claimed(before, name, guid) && owners_.emplace(guid, name).second) show(guid);
    }
  }
}

// The part of `info` that is well-formed and has room. @pre peer.claims is empty
Graph::Claims Graph::read_claims(const DiscoveryInfo& info, Peer& peer) {
  CULPRIT_ASSERT(peer.claims.empty());
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
    const bool is_more = !nodes_.contains(*name) && !is_component(*name);
    if (is_more &&
        (nodes_.size() + ++new_nodes > options_.limits.nodes ||
         !sources_.has_room(peer.source, &Source::names, options_.limits.nodes, claims.size()))) {
      warn_of_limit("nodes");
      break;
    }
    const std::size_t most = (is_component(*name) ? 2 : 1) * options_.limits.endpoints;
    std::set<rtps::Guid>& endpoints = claims[*name];
    for (const auto* guids : {&node.readers, &node.writers}) {
      for (const rtps::Guid& guid : *guids) {
        if (guid.prefix() != info.participant.prefix())
          continue;  // a participant announces only itself
        if (!endpoints.contains(guid) && claim_count_ >= most) {
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
  const rtps::GuidPrefix prefix = info.guid.prefix();
  if (const auto known = peers_.find(prefix); known != peers_.end()) {
    known->second.info = info;
    return;
  }
  const std::string source = options_.source_of ? options_.source_of(info) : "";
  const bool is_full = peers_.size() >= options_.limits.participants;
  const bool is_reserved = is_of_robot(info) && peers_.size() < 2 * options_.limits.participants;
  if (!is_reserved &&
      !sources_.has_room(source, &Source::participants, options_.limits.participants) &&
      !(is_full && source.empty() && make_room()))
    return warn_of_limit("participants");
  Peer& peer = peers_[prefix];
  peer.info = info;
  peer.source = source;
  peer.number = ++last_number_;
  ++sources_[source].participants;
}

void Graph::add(const rtps::EndpointInfo& info) {
  const auto peer = peers_.find(info.guid.prefix());
  if (peer == peers_.end()) return;
  if (const Endpoint* known = find(info.guid); known != nullptr) {
    if (known->info.topic == info.topic && known->info.type == info.type)
      return;  // only its QoS or user data
    hide(info.guid);
  } else if (!sources_.has_room(peer->second.source, &Source::endpoints,
                                options_.limits.endpoints) &&
             !(is_of_robot(peer->second.info) && endpoint_count_ < 2 * options_.limits.endpoints)) {
    return warn_of_limit("endpoints");
  } else {
    ++endpoint_count_;
    ++sources_[peer->second.source].endpoints;
  }
  peer->second.endpoints.insert_or_assign(info.guid, Endpoint{info, ros_meaning(info)});
  show(info.guid);
}

void Graph::remove_participant(const rtps::GuidPrefix& prefix) {
  looked_for_ = nullptr;
  const auto found = peers_.find(prefix);
  if (found == peers_.end()) return;
  // As if it had announced that it holds nothing, and then left.
  Peer& peer = found->second;
  const Claims before = std::exchange(peer.claims, {});
  for (const auto& [name, guids] : before) claim_count_ -= guids.size();
  replace_claims(prefix, peer, before, {});
  endpoint_count_ -= peer.endpoints.size();
  Source& source = sources_[peer.source];
  source.names -= before.size();
  source.endpoints -= peer.endpoints.size();
  if (--source.participants == 0) sources_.forget(peer.source);
  peers_.erase(found);
}

void Graph::forget_process(int pid) {
  std::vector<rtps::GuidPrefix> gone;
  for (const auto& [prefix, peer] : peers_) {
    if (peer.pid_is_known && peer.pid == pid && pid != 0) gone.push_back(prefix);
  }
  for (const rtps::GuidPrefix& prefix : gone) remove_participant(prefix);
}

void Graph::forget_ended_namesakes() {
  std::set<int> processes;
  std::set<rtps::GuidPrefix> unproven;
  for (const auto& [name, node] : nodes_) {
    if (node.claimants.size() < 2) continue;
    for (const rtps::GuidPrefix& claimant : node.claimants) {
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
  for (const rtps::GuidPrefix& prefix : unproven) remove_participant(prefix);
}

void Graph::remove_endpoint(const rtps::Guid& guid) {
  if (find(guid) == nullptr) return;
  hide(guid);
  Peer& peer = peers_.at(guid.prefix());
  peer.endpoints.erase(guid);
  --endpoint_count_;
  --sources_[peer.source].endpoints;
}

void Graph::claim(const rtps::GuidPrefix& prefix, const std::string& name) {
  Node& node = nodes_[name];
  Peer& peer = peers_.at(prefix);
  node.claimants.push_back(prefix);
  if (options_.is_kept_here && proven_here_.contains(name)) look_for_process(peer);
  if (!may_hold(name, peer)) return tell_of_stranger(name, peer);
  if (node.told) {
    warn_of_duplicate(name, node);
    // First, so that its leaving is no loss; and again below, when more is known of the new one.
    if (!has_ended(peers_.at(*node.told))) {
      count_namesakes(name, node);
      node.namesakes = -1;
    }
    tell_left(name, node);
  }
  tell_joined(name, node);
  count_namesakes(name, node);
}

void Graph::disclaim(const rtps::GuidPrefix& prefix, const std::string& name) {
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

bool Graph::may_hold(const std::string& name, const Peer& peer) const {
  return !proven_here_.contains(name) || peer.pid != 0 || peer.is_trusted || peer.info.is_secured;
}

void Graph::note_proven_here(const std::string& name) {
  if (options_.is_kept_here && options_.is_kept_here(name)) proven_here_.insert(name);
}

void Graph::look_at_unproven() {
  constexpr int kMost = 8;  // each may take a millisecond or more
  int looked_at = 0;
  std::vector<std::pair<std::string, rtps::GuidPrefix>> proven;
  for (const std::string& name : proven_here_) {
    const auto node = nodes_.find(name);
    if (node == nodes_.end()) continue;
    for (auto claimant = node->second.claimants.rbegin(); claimant != node->second.claimants.rend();
         ++claimant) {
      Peer& peer = peers_.at(*claimant);
      if (may_hold(name, peer) || peer.missing.empty() || ++looked_at > kMost) continue;
      looked_for_ = nullptr;
      look_for_process(peer);
      if (may_hold(name, peer)) proven.emplace_back(name, *claimant);
    }
  }
  for (const auto& [name, prefix] : proven) {
    std::erase(nodes_.at(name).claimants, prefix);
    claim(prefix, name);
  }
}

void Graph::show(const rtps::Guid& guid) {
  Node* node = holder_of(guid);
  const Endpoint* endpoint = find(guid);
  if (node == nullptr || endpoint == nullptr || !endpoint->ros) return;
  const GraphEndpoint& ros = *endpoint->ros;
  Edge& edge = node->edges.try_emplace(EdgeKey{ros.kind, ros.name}, Edge{ros}).first->second;
  if (++edge.count > 1) return;
  const std::string& name = owners_.at(guid);
  if (ros.kind == EndpointKind::kPublisher) published_[ros.name].emplace(name, &edge.endpoint);
  tell(EndpointJoined{name, ros});
}

void Graph::hide(const rtps::Guid& guid) {
  Node* node = holder_of(guid);
  const Endpoint* endpoint = find(guid);
  if (node == nullptr || endpoint == nullptr || !endpoint->ros) return;
  const GraphEndpoint& ros = *endpoint->ros;
  const auto edge = node->edges.find(EdgeKey{ros.kind, ros.name});
  if (--edge->second.count > 0) return;
  node->edges.erase(edge);
  tell_hidden(owners_.at(guid), EdgeKey{ros.kind, ros.name});
}

// @pre the edge is in no node any more
void Graph::tell_hidden(const std::string& node, const EdgeKey& edge) {
  const auto topic = published_.find(edge.second);
  if (edge.first == EndpointKind::kPublisher && topic != published_.end()) {
    topic->second.erase(node);
    if (topic->second.empty()) published_.erase(topic);
  }
  tell(EndpointLeft{node, edge.first, edge.second});
}

// The node that claims the endpoint, if that participant's node of this name is the one that
// counts.
Graph::Node* Graph::holder_of(const rtps::Guid& guid) {
  const auto owner = owners_.find(guid);
  if (owner == owners_.end()) return nullptr;
  const auto node = nodes_.find(owner->second);
  return node != nodes_.end() && node->second.told == guid.prefix() ? &node->second : nullptr;
}

void Graph::tell_joined(const std::string& name, Node& node) {
  const auto last = std::find_if(
      node.claimants.rbegin(), node.claimants.rend(),
      [&](const rtps::GuidPrefix& claimant) { return may_hold(name, peers_.at(claimant)); });
  if (last == node.claimants.rend()) return;
  node.told = *last;
  Peer& peer = peers_.at(*node.told);
  look_for_process(peer);
  tell_of_missing(name, peer);
  if (peer.pid != 0) note_proven_here(name);
  count_component(node, is_component(name));
  tell(NodeJoined{describe(name, peer)});
  // Those that were known before: an older node of the name comes to count again.
  const auto claimed = peer.claims.find(name);
  if (claimed == peer.claims.end()) return;
  for (const rtps::Guid& guid : claimed->second) {
    if (const auto owner = owners_.find(guid); owner != owners_.end() && owner->second == name)
      show(guid);
  }
}

void Graph::tell_left(const std::string& name, Node& node) {
  for (const auto& [key, edge] : std::exchange(node.edges, {})) tell_hidden(name, key);
  count_component(node, false);
  node.told.reset();
  tell(NodeLeft{name, is_losing_});
}

const Graph::Endpoint* Graph::find(const rtps::Guid& guid) const {
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

// Looks for a node that the peer comes to hold; of several at once, for the first. If a process has
// ended, nothing can be proven of it any more, and the old proof stays.
void Graph::look_for_process(Peer& peer) {
  const bool is_next = std::exchange(looked_for_, &peer) == &peer;
  if (!is_next && options_.find_process && (peer.pid == 0 || !has_ended(peer))) {
    FoundProcess found = options_.find_process(peer.info);
    peer.pid = found.pid;
    peer.pid_is_known = true;
    peer.missing = std::move(found.missing);
    peer.is_trusted = found.is_trusted;
    if (peer.missing.empty()) peer.told_missing.clear();
  }
}

// Once for all nodes of a process, by the first one that lacks it.
void Graph::tell_of_missing(const std::string& name, Peer& peer) {
  if (peer.missing == peer.told_missing) return;
  if (options_.is_ended_by_others && options_.is_ended_by_others(name)) return;
  tell(GraphTrouble{"the process of " + name +
                    " is not proven, so it is not ended: " + peer.missing});
  peer.told_missing = peer.missing;
}

void Graph::tell_of_stranger(const std::string& name, Peer& peer) {
  if (std::exchange(peer.told_of_stranger, true)) return;
  tell(GraphTrouble{where(describe(name, peer)) + " claims the name " + name +
                    ", which a process of this computer is proven to have, or had: it does not "
                    "count. If the node was moved "
                    "there, declare its HOST"});
}

GraphNode Graph::describe(const std::string& name, const Peer& peer) const {
  return {name, peer.info.vendor, peer.info.host, peer.pid, peer.info.guid.prefix()};
}

// Hidden nodes are what people look with, and several may look at once.
void Graph::warn_of_duplicate(const std::string& name, const Node& node) {
  if (own_name(name).starts_with('_')) return;
  Peer& older = peers_.at(*node.told);
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
  for (const rtps::GuidPrefix& claimant : node.claimants) {
    Peer& peer = peers_.at(claimant);
    if (claimant != node.told) pid_of(peer);
    if (!may_hold(name, peer)) continue;
    const bool is_gone = claimant != node.told && has_ended(peer);
    if (!is_gone) all.push_back(describe(name, peer));
  }
  const int others = std::max(static_cast<int>(all.size()) - 1, 0);
  if (std::exchange(node.namesakes, others) != others)
    tell(NodeNamesakes{name, others, std::move(all)});
}

bool Graph::is_of_robot(const ParticipantInfo& participant) const {
  return std::ranges::any_of(participant.nodes,
                             [this](const std::string& node) { return is_component(node); });
}

bool Graph::is_component(const std::string& name) const {
  return options_.is_component && options_.is_component(name);
}

// @pre node.told
void Graph::count_component(Node& node, bool is_one) {
  if (std::exchange(node.is_counted, is_one) == is_one) return;
  std::size_t& count = sources_[peers_.at(*node.told).source].components;
  count = is_one ? count + 1 : count - 1;
}

// A participant of this machine that is there for longest without any node goes. A ROS 2
// participant announces its nodes at once.
bool Graph::make_room() {
  const Peer* oldest = nullptr;
  for (const auto& [prefix, peer] : peers_) {
    if (!peer.source.empty() || !peer.claims.empty()) continue;
    if (oldest == nullptr || peer.number < oldest->number) oldest = &peer;
  }
  if (oldest == nullptr) return false;
  warn_of_limit("participants");
  remove_participant(oldest->info.guid.prefix());
  return true;
}

void Graph::warn_of_limit(const char* what) {
  if (exceeded_.insert(what).second) {
    tell(GraphTrouble{std::string("there are too many ") + what +
                      " to keep track of; further ones are left out"});
  }
}

const ParticipantInfo* Graph::participant(const rtps::GuidPrefix& prefix) const {
  const auto found = peers_.find(prefix);
  return found == peers_.end() ? nullptr : &found->second.info;
}

Graph::Owner Graph::owner_of(const rtps::Guid& endpoint) const {
  Owner owner;
  const auto peer = peers_.find(endpoint.prefix());
  if (peer != peers_.end()) owner.pid = peer->second.pid;
  const auto claimed = owners_.find(endpoint);
  if (claimed == owners_.end()) return owner;
  owner.node = claimed->second;
  const auto node = nodes_.find(owner.node);
  owner.counts = node != nodes_.end() && node->second.told == endpoint.prefix();
  return owner;
}

int Graph::process_of(const rtps::GuidPrefix& prefix) const {
  const auto peer = peers_.find(prefix);
  return peer == peers_.end() ? 0 : peer->second.pid;
}

int Graph::process_of(const std::string& name) const {
  const auto found = nodes_.find(name);
  return found == nodes_.end() || !found->second.told ? 0 : process_of(*found->second.told);
}

std::optional<GraphNode> Graph::node(const std::string& name) const {
  const auto found = nodes_.find(name);
  if (found == nodes_.end() || !found->second.told) return std::nullopt;
  return describe(name, peers_.at(*found->second.told));
}

const Graph::Publishers& Graph::nodes_publishing(const std::string& topic) const {
  static const Publishers kNone;
  const auto found = published_.find(topic);
  return found == published_.end() ? kNone : found->second;
}

std::vector<std::pair<rtps::Guid, std::string>> Graph::publishers_of(
    const std::string& topic) const {
  std::vector<std::pair<rtps::Guid, std::string>> publishers;
  for (const auto& [guid, node] : owners_) {
    const Endpoint* found = find(guid);
    const bool is_it = found != nullptr && found->ros && found->ros->name == topic &&
                       found->ros->kind == EndpointKind::kPublisher;
    if (is_it) publishers.emplace_back(guid, node);
  }
  return publishers;
}

const rtps::EndpointInfo* Graph::endpoint(const rtps::Guid& guid) const {
  const Endpoint* found = find(guid);
  return found == nullptr ? nullptr : &found->info;
}

std::vector<Graph::NodeView> Graph::bare_nodes() const {
  std::vector<NodeView> views;
  views.reserve(nodes_.size());
  for (const auto& [name, node] : nodes_) {
    if (node.told) views.push_back({describe(name, peers_.at(*node.told)), {}, *node.told});
  }
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
          guids, [&](const rtps::Guid& guid) { return !peer.endpoints.contains(guid); }));
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
