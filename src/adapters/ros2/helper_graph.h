// The graph that a helper program sees, as discovery on DDS would have told it: participants, their endpoints, and the
// announcements of their nodes. So all that is built on discovery (context.h, graph.h) works on any middleware.
//
// - Middlewares on DDS give each endpoint its GUID: the first twelve bytes are the participant's. Others give some id.
//   Then each node is a participant of its own, named after the id of an endpoint that lives as long as the node.
// - Services have no ids here. Each gets two endpoints of our own making, of the node's newest participant: a killed
//   node stays in the graph for a while, beside its successor.
// - Names from the network that break the grammar are left out.
//
// A pure data structure.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "culprit_link/protocol.h"
#include "ros2/discovery_info.h"
#include "ros2/participant.h"

namespace culprit::ros2 {

class HelperGraph {
 public:
  // kKeep: what is missing stays for now, since the helper may just not have discovered it yet.
  enum class Missing : std::uint8_t { kLeft, kKeep };
  using Change = std::variant<DiscoveryEvent, DiscoveryInfo>;

  // `middleware`: "rmw_fastrtps_cpp". `own`: the id of an endpoint of the helper.
  void begin(const std::string& middleware, const culprit_link::Gid& own, std::string own_node);

  // The source (Graph::SourceOf) of a participant. On Fast DDS its computer, which its GUID names: anybody may name
  // another one, but all strangers together have no more than half of the room. Participants of another vendor count as
  // one source, for no part of their GUIDs is common to a computer. A helper on another middleware than Fast DDS does not
  // know which are of this machine: there all are taken to be.
  static std::string source_of(const ParticipantInfo& participant);

  // Returns the changes since the last graph, in an order that discovery could have had.
  std::vector<Change> take(const culprit_link::GraphSeen& seen, Missing missing);
  // Whether something is kept that the last graph did not have.
  bool has_missing() const { return has_missing_; }
  // Participants with endpoints and without a node: their announcement of nodes has not come, or they are not of ROS.
  // Ascending.
  std::vector<rtps::GuidPrefix> without_nodes() const;

  // The announcements that hold now.
  std::vector<DiscoveryInfo> infos() const;
  // The endpoints of others that match one of ours, in its opposite role. DDS names.
  const std::set<rtps::Guid>& matching(const std::string& topic, rtps::EndpointRole role) const;
  // The writer that a sample came from: the id that the middleware gives is not always the endpoint's; one publisher
  // alone can have sent it.
  rtps::Guid writer_of(const std::string& topic, const culprit_link::Gid& given) const;

 private:
  struct Peer {
    ParticipantInfo info;
    std::map<rtps::Guid, rtps::EndpointInfo> endpoints;
    std::map<std::string, NodeEntities> nodes;  // by full name
    std::uint64_t number = 0;                   // in the order in which they came
  };
  using Peers = std::map<rtps::GuidPrefix, Peer>;
  using SeenGraph = culprit_link::GraphSeen;

  Peers read(const SeenGraph& seen);
  void read_endpoints(const SeenGraph& seen, Peers& peers);
  void read_services(const SeenGraph& seen, Peers& peers);
  Peer& peer_of(const rtps::GuidPrefix& prefix, Peers& peers) const;
  std::map<std::string, rtps::GuidPrefix> anchors_of(const SeenGraph& seen);
  rtps::Guid made_guid(const rtps::GuidPrefix& prefix, const std::string& topic,
                       rtps::EndpointRole role);

  bool has_guids_ = false;  // the middleware's ids are GUIDs
  bool has_pids_ = false;   // and tell the process (Fast DDS)
  culprit_link::Gid own_{};
  std::set<rtps::GuidPrefix> helpers_;  // participants of this helper and its predecessors
  std::string own_node_;
  Peers peers_;
  std::map<std::string, rtps::GuidPrefix> anchors_;  // of nodes, where ids are no GUIDs
  std::map<std::tuple<rtps::GuidPrefix, std::string, rtps::EndpointRole>, rtps::Guid> made_;
  std::uint32_t last_made_ = 0;
  std::uint64_t last_number_ = 0;
  bool has_missing_ = false;
  std::map<std::pair<std::string, bool>, std::set<rtps::Guid>> by_topic_;  // and whether they read
};

}  // namespace culprit::ros2
