#include "ros2/helper_graph.h"

#include <algorithm>
#include <utility>

#include "base/environment.h"
#include "ros2/names.h"

namespace culprit::ros2 {
namespace {

constexpr std::array<std::uint8_t, 4> kParticipantEntity = {0, 0, 1, 0xc1};
constexpr std::array<std::uint8_t, 2> kFastDds = {
    1, 15};  // a GUID of it begins so (RTPS 2.3 §9.3.1.5)
constexpr std::uint8_t kReaderKind = 0x04;
constexpr std::uint8_t kWriterKind = 0x03;

rtps::Guid to_guid(const culprit_link::Gid& gid) {
  rtps::Guid guid;
  guid.bytes = gid;
  return guid;
}

rtps::Guid guid_of(const rtps::GuidPrefix& prefix, const std::array<std::uint8_t, 4>& entity) {
  rtps::Guid guid;
  std::ranges::copy(prefix.bytes, guid.bytes.begin());
  std::ranges::copy(entity, guid.bytes.begin() + prefix.bytes.size());
  return guid;
}

// For a node without an endpoint that has an id.
rtps::GuidPrefix prefix_of_name(const std::string& node) {
  rtps::GuidPrefix prefix;
  std::uint64_t first = 0xcbf29ce484222325;
  for (const char c : node) first = (first ^ static_cast<std::uint8_t>(c)) * 0x100000001b3;
  for (std::size_t i = 0; i < 8; ++i)
    prefix.bytes[4 + i] = static_cast<std::uint8_t>(first >> (8 * i));
  return prefix;
}

std::optional<NodeName> name_of(const culprit_link::GraphSeen::Node& node) {
  if (!is_valid_namespace(node.name_space) || !is_valid_node_name(node.name)) return std::nullopt;
  return NodeName{node.name_space, node.name};
}

Duration to_duration(std::int64_t nanoseconds) {
  return nanoseconds > 0 ? Duration(nanoseconds) : rtps::kInfinite;
}

rtps::Qos to_qos(const culprit_link::Quality& quality) {
  rtps::Qos qos;
  qos.reliability =
      quality.is_reliable ? rtps::Reliability::kReliable : rtps::Reliability::kBestEffort;
  qos.durability =
      quality.is_transient_local ? rtps::Durability::kTransientLocal : rtps::Durability::kVolatile;
  qos.deadline = to_duration(quality.deadline);
  qos.lifespan = to_duration(quality.lifespan);
  qos.liveliness =
      quality.asserts_liveliness ? rtps::Liveliness::kManualByTopic : rtps::Liveliness::kAutomatic;
  qos.liveliness_lease = to_duration(quality.lease);
  return qos;
}

// Topics that every node publishes for as long as it lives, first.
int rank_as_anchor(const culprit_link::GraphSeen::Endpoint& endpoint) {
  if (!endpoint.is_publisher) return 3;
  if (endpoint.topic == "/parameter_events") return 0;
  return endpoint.topic == "/rosout" ? 1 : 2;
}

}  // namespace

void HelperGraph::begin(const std::string& middleware, const culprit_link::Gid& own,
                        std::string own_node) {
  const auto has = [&](const char* word) { return middleware.find(word) != std::string::npos; };
  has_pids_ = has("fastrtps");
  has_guids_ = has_pids_ || has("cyclonedds") || has("connextdds");
  own_ = own;
  // A killed one stays in the graph until its lease ends, and its successor's successor does not discover it any more.
  if (has_guids_) helpers_.insert(to_guid(own).prefix());
  own_node_ = std::move(own_node);
}

HelperGraph::Peer& HelperGraph::peer_of(const rtps::GuidPrefix& prefix, Peers& peers) const {
  const auto [found, is_new] = peers.try_emplace(prefix);
  Peer& peer = found->second;
  if (!is_new) return peer;
  peer.info.guid = guid_of(prefix, kParticipantEntity);
  if (!has_pids_) return peer;
  // Fast DDS: vendor, host, process, random bytes, number (two bytes each, the last one four).
  const bool is_here = std::equal(prefix.bytes.begin(), prefix.bytes.begin() + 4, own_.begin());
  peer.info.host = is_here ? host_name() : "another computer";
  peer.info.pid = is_here ? prefix.bytes[4] | prefix.bytes[5] << 8 : 0;
  return peer;
}

std::map<std::string, rtps::GuidPrefix> HelperGraph::anchors_of(const SeenGraph& seen) {
  std::map<std::string, std::set<std::pair<int, culprit_link::Gid>>> ids;
  for (const auto& endpoint : seen.endpoints) {
    if (const auto name = name_of(endpoint.node))
      ids[name->full()].emplace(rank_as_anchor(endpoint), endpoint.gid);
  }
  std::map<std::string, rtps::GuidPrefix> anchors;
  for (const auto& [node, all] : ids) {
    const auto known = anchors_.find(node);
    const auto stays = std::ranges::find_if(all, [&](const auto& each) {
      return known != anchors_.end() && to_guid(each.second).prefix() == known->second;
    });
    anchors[node] = to_guid(stays == all.end() ? all.begin()->second : stays->second).prefix();
  }
  anchors_ = anchors;
  return anchors;
}

void HelperGraph::read_endpoints(const SeenGraph& seen, Peers& peers) {
  const auto anchors = has_guids_ ? std::map<std::string, rtps::GuidPrefix>() : anchors_of(seen);
  for (const auto& each : seen.endpoints) {
    const auto name = name_of(each.node);
    const bool is_own = has_guids_ ? helpers_.contains(to_guid(each.gid).prefix())
                                   : name && name->full() == own_node_;
    if (is_own) continue;
    if (!is_valid_topic_name(each.topic) || !is_valid_type_name(each.type)) continue;
    if (!name && !has_guids_) continue;
    const rtps::Guid given = to_guid(each.gid);
    const rtps::GuidPrefix prefix = has_guids_ ? given.prefix() : anchors.at(name->full());
    const rtps::EndpointRole role =
        each.is_publisher ? rtps::EndpointRole::kWriter : rtps::EndpointRole::kReader;
    rtps::EndpointInfo info;
    info.topic = mangle_topic(Channel::kTopic, each.topic);
    info.type = mangle_type(Channel::kTopic, each.type);
    // An id that is no GUID has no kind, and not the prefix of its participant.
    info.guid =
        has_guids_
            ? given
            : made_guid(prefix, info.topic + std::string(each.gid.begin(), each.gid.end()), role);
    if (!each.type_hash.empty()) info.user_data = "typehash=" + each.type_hash + ";";
    info.qos = to_qos(each.quality);
    Peer& peer = peer_of(prefix, peers);
    if (name) {
      NodeEntities& node = peer.nodes[name->full()];
      node.name_space = name->name_space;
      node.name = name->name;
      (each.is_publisher ? node.writers : node.readers).push_back(info.guid);
    }
    peer.endpoints.emplace(info.guid, std::move(info));
  }
}

rtps::Guid HelperGraph::made_guid(const rtps::GuidPrefix& prefix, const std::string& topic,
                                  rtps::EndpointRole role) {
  const auto [found, is_new] = made_.try_emplace({prefix, topic, role});
  if (!is_new) return found->second;
  const std::uint32_t number = ++last_made_;
  found->second =
      guid_of(prefix, {static_cast<std::uint8_t>(0xc0 | (number >> 16 & 0x3f)),
                       static_cast<std::uint8_t>(number >> 8), static_cast<std::uint8_t>(number),
                       role == rtps::EndpointRole::kReader ? kReaderKind : kWriterKind});
  return found->second;
}

void HelperGraph::read_services(const SeenGraph& seen, Peers& peers) {
  std::map<std::string, rtps::GuidPrefix> newest;
  for (const auto& [prefix, peer] : peers) {
    const auto number_of = [this](const rtps::GuidPrefix& each) {
      const auto known = peers_.find(each);
      return known == peers_.end() ? last_number_ + 1 : known->second.number;
    };
    for (const auto& [node, entities] : peer.nodes) {
      const auto [found, is_new] = newest.try_emplace(node, prefix);
      if (!is_new && number_of(prefix) >= number_of(found->second)) found->second = prefix;
    }
  }
  for (const auto& each : seen.nodes) {
    const auto name = name_of(each);
    if (!name || name->full() == own_node_ || newest.contains(name->full())) continue;
    const rtps::GuidPrefix prefix = prefix_of_name(name->full());
    newest[name->full()] = prefix;
    peer_of(prefix, peers).nodes[name->full()] = {name->name_space, name->name, {}, {}};
  }
  for (const auto& each : seen.services) {
    const auto name = name_of(each.node);
    if (!name || !is_valid_topic_name(each.name) || !is_valid_type_name(each.type)) continue;
    const auto owner = newest.find(name->full());
    if (owner == newest.end()) continue;
    Peer& peer = peers.at(owner->second);
    NodeEntities& node = peer.nodes.at(name->full());
    for (const Channel channel : {Channel::kRequest, Channel::kReply}) {
      const bool reads = (channel == Channel::kRequest) == each.is_server;
      rtps::EndpointInfo info;
      info.topic = mangle_topic(channel, each.name);
      info.type = mangle_type(channel, each.type);
      info.guid = made_guid(owner->second, info.topic + " " + name->full(),
                            reads ? rtps::EndpointRole::kReader : rtps::EndpointRole::kWriter);
      (reads ? node.readers : node.writers).push_back(info.guid);
      peer.endpoints.emplace(info.guid, std::move(info));
    }
  }
}

HelperGraph::Peers HelperGraph::read(const SeenGraph& seen) {
  Peers peers;
  read_endpoints(seen, peers);
  read_services(seen, peers);
  for (auto& [prefix, peer] : peers) {
    for (auto& [node, entities] : peer.nodes) {
      peer.info.nodes.push_back(node);
      std::ranges::sort(entities.readers);
      std::ranges::sort(entities.writers);
    }
  }
  return peers;
}

namespace {

DiscoveryInfo info_of(const ParticipantInfo& participant,
                      const std::map<std::string, NodeEntities>& nodes) {
  DiscoveryInfo info{participant.guid, {}};
  for (const auto& [name, entities] : nodes) info.nodes.push_back(entities);
  return info;
}

}  // namespace

std::vector<HelperGraph::Change> HelperGraph::take(const SeenGraph& seen, Missing missing) {
  Peers now = read(seen);
  std::vector<Change> changes;
  has_missing_ = false;
  for (auto& [prefix, before] : peers_) {
    const auto found = now.find(prefix);
    const bool lacks_nodes =
        found == now.end() || std::ranges::any_of(before.nodes, [&](const auto& node) {
          return !found->second.nodes.contains(node.first);
        });
    const bool lacks_endpoints =
        found == now.end() || std::ranges::any_of(before.endpoints, [&](const auto& endpoint) {
          return !found->second.endpoints.contains(endpoint.first);
        });
    if (missing == Missing::kKeep && (lacks_nodes || lacks_endpoints)) {
      has_missing_ = true;
      Peer kept = before;
      if (found != now.end()) {
        for (auto& [guid, endpoint] : found->second.endpoints) kept.endpoints[guid] = endpoint;
        for (auto& [name, node] : found->second.nodes) kept.nodes.try_emplace(name, node);
      }
      now.insert_or_assign(prefix, std::move(kept));
    } else if (found == now.end()) {
      changes.emplace_back(DiscoveryEvent(ParticipantGone{before.info.guid, false}));
    }
  }
  for (auto& [prefix, peer] : now) {
    const auto known = peers_.find(prefix);
    const Peer before = known == peers_.end() ? Peer() : known->second;
    peer.number = known == peers_.end() ? ++last_number_ : before.number;
    if (peer.info != before.info) changes.emplace_back(DiscoveryEvent(peer.info));
    for (const auto& [guid, endpoint] : peer.endpoints) {
      const auto same = before.endpoints.find(guid);
      if (same == before.endpoints.end() || same->second != endpoint)
        changes.emplace_back(DiscoveryEvent(endpoint));
    }
    if (peer.nodes != before.nodes || known == peers_.end())
      changes.emplace_back(info_of(peer.info, peer.nodes));
    for (const auto& [guid, endpoint] : before.endpoints) {
      if (!peer.endpoints.contains(guid))
        changes.emplace_back(DiscoveryEvent(rtps::EndpointGone{guid}));
    }
  }
  peers_ = std::move(now);
  by_topic_.clear();
  for (const auto& [prefix, peer] : peers_) {
    for (const auto& [guid, endpoint] : peer.endpoints)
      by_topic_[{endpoint.topic, guid.is_reader()}].insert(guid);
  }
  // A node may make ever new services.
  std::erase_if(made_, [this](const auto& each) {
    const auto peer = peers_.find(std::get<rtps::GuidPrefix>(each.first));
    return peer == peers_.end() || !peer->second.endpoints.contains(each.second);
  });
  return changes;
}

std::string HelperGraph::source_of(const ParticipantInfo& participant) {
  if (participant.host.empty() || participant.host == host_name()) return "";
  const rtps::GuidPrefix prefix = participant.guid.prefix();
  if (!std::equal(kFastDds.begin(), kFastDds.end(), prefix.bytes.begin())) return "another vendor";
  return "computer " + std::to_string(prefix.bytes[2] << 8 | prefix.bytes[3]);
}

std::vector<DiscoveryInfo> HelperGraph::infos() const {
  std::vector<DiscoveryInfo> all;
  for (const auto& [prefix, peer] : peers_) all.push_back(info_of(peer.info, peer.nodes));
  return all;
}

std::vector<rtps::GuidPrefix> HelperGraph::without_nodes() const {
  std::vector<rtps::GuidPrefix> found;
  for (const auto& [prefix, peer] : peers_) {
    if (peer.nodes.empty() && !peer.endpoints.empty()) found.push_back(prefix);
  }
  return found;
}

const std::set<rtps::Guid>& HelperGraph::matching(const std::string& topic,
                                                  rtps::EndpointRole role) const {
  static const std::set<rtps::Guid> kNone;
  const auto found = by_topic_.find({topic, role == rtps::EndpointRole::kWriter});
  return found == by_topic_.end() ? kNone : found->second;
}

rtps::Guid HelperGraph::writer_of(const std::string& topic, const culprit_link::Gid& given) const {
  const std::set<rtps::Guid>& writers = matching(topic, rtps::EndpointRole::kReader);
  const rtps::Guid guid = to_guid(given);
  return writers.size() == 1 && !writers.contains(guid) ? *writers.begin() : guid;
}

}  // namespace culprit::ros2
