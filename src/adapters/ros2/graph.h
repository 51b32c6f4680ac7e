// The live graph: which nodes there are, and which topics and services each of them offers or uses.
//
// DDS reports the endpoints; `ros_discovery_info` assigns them to nodes. The graph is the join of
// both, and reports every change to its listener, edge by edge, in an order that makes sense: a
// node before its endpoints, and its endpoints away before the node.
//
// - A service server is its reader of requests, a client its writer of requests. Two endpoints of
//   one node, kind and name are one edge: it appears with the first and vanishes with the last.
// - Two nodes of one name: the one that came last is the node, for a restarted process comes while
//   its killed predecessor's lease still runs (20 s). The change is reported as a vanishing and an
//   appearing, and as trouble unless the predecessor's process is known to have exited.
// - A process of this machine may be proven to hold a name that belongs here (is_kept_here). Then
//   participants without such a proof lose that name, both as the node and as its namesake: any
//   participant may claim a name. It is reported once.
// - If a participant says that it holds a node no more, and that node is_asked_about, the graph does
//   not believe it at once: it reports NodeSaidToLeave, and the listener finds out. A participant
//   that leaves takes its nodes with it.
// - Names come from the network. Nodes whose names break the grammar are left out and reported as
//   trouble once for each participant; endpoints that are not ROS 2's are left out silently.
// - Tables are capped, and shared between the sources of participants (graph_sources.h). On this machine a
//   participant that holds no node makes room for another.
//
// A pure data structure: fed by one thread, no I/O, no clock.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

#include "base/endpoint_kind.h"
#include "ros2/discovery_info.h"
#include "ros2/graph_endpoint.h"
#include "ros2/graph_sources.h"
#include "ros2/names.h"
#include "ros2/participant.h"

namespace culprit::ros2 {

struct GraphNode {
  std::string name;  // full: "/namespace/name"
  Vendor vendor = Vendor::kOther;
  std::string host;                // empty if the participant announces none
  int pid = 0;                     // on this machine; 0 where it is not known
  rtps::GuidPrefix participant{};  // that holds it
};

// The process of a participant, as far as it is proven.
struct FoundProcess {
  int pid = 0;  // on this machine; 0: it is elsewhere, or not proven
  // The missing part of a proof, in words: "nobody here has ...". Empty where nothing is claimed.
  std::string missing;
  // It was on this machine, and no process holds its sockets any more.
  bool has_ended = false;
  bool is_trusted = false;  // not proven, but root or our own user made each of its sockets here
};

struct NodeJoined {
  GraphNode node;
};
struct NodeLeft {
  std::string node;
  bool was_lost = false;  // without leaving in order: its lease ran out
};
struct EndpointJoined {
  std::string node;
  GraphEndpoint endpoint;
};
struct EndpointLeft {
  std::string node;
  EndpointKind kind;
  std::string name;
};
// How many nodes there are beside the one that counts, in processes that are not known to be gone.
struct NodeNamesakes {
  std::string node;
  int others = 0;
  std::vector<GraphNode> all;  // of them and the one that counts, the newest last
};
// The node is still there for the graph: a message in the name of its participant announced that it
// is not.
struct NodeSaidToLeave {
  std::string node;
};
struct GraphTrouble {
  std::string text;
};
using GraphChange = std::variant<NodeJoined, NodeLeft, EndpointJoined, EndpointLeft, NodeNamesakes,
                                 NodeSaidToLeave, GraphTrouble>;

class Graph {
 public:
  struct Limits {
    std::size_t participants = 1000;
    std::size_t nodes = 10'000;
    std::size_t endpoints = 100'000;  // discovered, and as many again claimed; twice for components
  };
  // Asked for each node that a participant comes to hold: new evidence against it may have come
  // since the last call.
  using FindProcess = std::function<FoundProcess(const ParticipantInfo&)>;
  using IsRunning = std::function<bool(int pid)>;
  // Whether somebody else ends what this node runs in: then nothing is missing without a proof.
  using IsEndedByOthers = std::function<bool(const std::string& node)>;
  // Whether only a process of this machine may hold a node of this name, once one was proven to.
  using IsKeptHere = std::function<bool(const std::string& node)>;
  // Whether it is known from elsewhere that there is a node of this name: it always has room.
  using IsComponent = std::function<bool(const std::string& node)>;
  // Where the datagrams of a participant come from; empty: this machine.
  using SourceOf = std::function<std::string(const ParticipantInfo&)>;
  using IsAskedAbout = std::function<bool(const std::string& node)>;
  // It may ask the graph for nodes, their processes and what they publish, as after the change, and
  // for nothing else.
  using Listener = std::function<void(const GraphChange&)>;

  struct Options {
    Listener listener{};
    FindProcess find_process{};            // may be empty
    IsRunning is_running{};                // may be empty
    IsEndedByOthers is_ended_by_others{};  // may be empty
    IsKeptHere is_kept_here{};             // may be empty
    IsAskedAbout is_asked_about{};         // may be empty
    IsComponent is_component{};            // may be empty
    SourceOf source_of{};                  // empty: all are of this machine
    Limits limits{};
  };

  explicit Graph(Options options);
  Graph(const Graph&) = delete;

  void apply(const DiscoveryEvent& event);
  // The nodes of `info.participant`, as it announced them in this form; replaces the earlier
  // announcement.
  void apply(const DiscoveryInfo& info, std::optional<GidSize> form = {});
  // A process of this machine has ended: its participants have left, though leases may still run.
  void forget_process(int pid);
  // As above, for all participants that claim a name that others claim too, and that have ended by
  // now. The operating system shows that by their processes, or by their sockets if no process is
  // proven.
  void forget_ended_namesakes();

  // It is proven that the node of NodeSaidToLeave has left.
  void believe_left(const std::string& node);
  // Whether that was reported, and is neither believed nor taken back.
  bool is_said_to_leave(const std::string& node) const;
  // A process of this machine was proven to hold this name before.
  void note_proven_here(const std::string& node);
  // Checks the participants again that claim a name without a proof: a process may be proven later
  // than its node is discovered.
  void look_at_unproven();

  // Null when they are not known (any more).
  const ParticipantInfo* participant(const rtps::GuidPrefix& prefix) const;
  const rtps::EndpointInfo* endpoint(const rtps::Guid& guid) const;
  // The node of this name that counts.
  std::optional<GraphNode> node(const std::string& name) const;
  // The nodes that count and publish a topic, each with its endpoint. Until the graph changes.
  using Publishers = std::map<std::string, const GraphEndpoint*>;
  const Publishers& nodes_publishing(const std::string& topic) const;
  // The same of each topic that has one.
  const std::map<std::string, Publishers>& published() const { return published_; }
  // The endpoints that publish the topic, each with its node, whether that counts or not.
  std::vector<std::pair<rtps::Guid, std::string>> publishers_of(const std::string& topic) const;
  // The owner of an endpoint: no node, while none claims it.
  struct Owner {
    std::string node;
    int pid = 0;          // on this machine, as far as it is proven
    bool counts = false;  // of those that claim the node's name it is the one that counts
  };
  Owner owner_of(const rtps::Guid& endpoint) const;
  // Its process on this machine; 0: it is elsewhere, or not proven, or not known.
  int process_of(const rtps::GuidPrefix& prefix) const;
  int process_of(const std::string& node) const;

  // Every node, by name, with its endpoints.
  struct NodeView {
    GraphNode node;
    std::vector<GraphEndpoint> endpoints;
    rtps::GuidPrefix participant{};  // that holds it
  };
  std::vector<NodeView> nodes() const;
  // The same without their endpoints: participants() has those, too.
  std::vector<NodeView> bare_nodes() const;

  // Every participant, with all that it has: also nodes that do not count, since another has their
  // name, and each of several endpoints of one node, kind and name.
  struct OwnedEndpoint {
    rtps::Guid id;
    std::string node;  // empty: no node claims it
    GraphEndpoint endpoint;
  };
  struct ParticipantView {
    ParticipantInfo info;
    int pid = 0;                    // on this machine, as far as it is known
    std::optional<GidSize> form{};  // of its announcement of nodes; nothing: there was none
    std::vector<std::string> nodes{};
    std::vector<OwnedEndpoint> endpoints{};
    std::size_t undiscovered = 0;  // endpoints that its nodes claim, and that were not discovered
  };
  std::vector<ParticipantView> participants() const;

 private:
  struct Endpoint {
    rtps::EndpointInfo info;
    std::optional<GraphEndpoint>
        ros;  // what it means; nothing where it is no ROS 2 endpoint, or its other half
  };
  using Claims = std::map<std::string, std::set<rtps::Guid>>;  // node -> its endpoints
  struct Peer {
    ParticipantInfo info;
    int pid = 0;
    bool pid_is_known = false;
    std::string missing;       // for a proof of its process
    std::string told_missing;  // the last one that was reported
    bool is_trusted = false;
    std::set<std::string> doubted;  // nodes that it announced to hold no more
    bool told_of_stranger = false;
    std::string source;
    std::uint64_t number = 0;  // in the order in which they came
    bool told_of_invalid_name = false;
    bool told_of_duplicate = false;
    std::optional<GidSize> form;
    Claims claims;
    std::unordered_map<rtps::Guid, Endpoint> endpoints;
  };
  using Source = GraphSources::Entries;
  using EdgeKey = std::pair<EndpointKind, std::string>;
  struct Edge {
    GraphEndpoint endpoint;
    int count = 0;  // of the endpoints that make it
  };
  struct Node {
    // Those that announce this node; the last one that may counts.
    std::vector<rtps::GuidPrefix> claimants;
    std::optional<rtps::GuidPrefix> told;  // whose node the listener knows
    std::map<EdgeKey, Edge> edges;         // that the listener knows
    int namesakes = 0;                     // that the listener knows
    bool is_counted = false;               // Source::components, of `told`
  };

  void add(const ParticipantInfo& info);
  void add(const rtps::EndpointInfo& info);
  void remove_participant(const rtps::GuidPrefix& prefix);
  void remove_endpoint(const rtps::Guid& guid);

  Claims read_claims(const DiscoveryInfo& info, Peer& peer);
  void keep_doubted(const rtps::GuidPrefix& prefix, Peer& peer, const Claims& before,
                    Claims& after);
  void replace_claims(const rtps::GuidPrefix& prefix, Peer& peer, const Claims& before,
                      Claims after);
  void claim(const rtps::GuidPrefix& prefix, const std::string& name);
  void disclaim(const rtps::GuidPrefix& prefix, const std::string& name);
  // The edge that an endpoint makes, if it is discovered, and claimed by a node that counts.
  void show(const rtps::Guid& guid);
  void hide(const rtps::Guid& guid);
  void tell_hidden(const std::string& node, const EdgeKey& edge);
  Node* holder_of(const rtps::Guid& guid);
  void tell_joined(const std::string& name, Node& node);
  void tell_left(const std::string& name, Node& node);

  const Endpoint* find(const rtps::Guid& guid) const;
  int pid_of(Peer& peer);
  bool has_ended(const Peer& peer) const;
  void look_for_process(Peer& peer);
  bool may_hold(const std::string& name, const Peer& peer) const;
  void tell_of_stranger(const std::string& name, Peer& peer);
  void tell_of_missing(const std::string& name, Peer& peer);
  GraphNode describe(const std::string& name, const Peer& peer) const;
  void warn_of_duplicate(const std::string& name, const Node& node);
  void count_namesakes(const std::string& name, Node& node);
  void warn_of_limit(const char* what);
  bool is_component(const std::string& name) const;
  // Whether its announcement names a component: it has room beyond the limits, as many again.
  bool is_of_robot(const ParticipantInfo& participant) const;
  bool make_room();
  void count_component(Node& node, bool is_one);
  void tell(const GraphChange& change) const;

  Options options_;
  std::unordered_map<rtps::GuidPrefix, Peer> peers_;
  GraphSources sources_;
  std::uint64_t last_number_ = 0;                       // of a participant
  std::size_t endpoint_count_ = 0;                      // discovered, of all peers
  std::size_t claim_count_ = 0;                         // claimed, of all peers
  std::unordered_map<rtps::Guid, std::string> owners_;  // endpoint -> the node that claims it
  std::map<std::string, Node> nodes_;
  std::map<std::string, Publishers> published_;  // by topic; of the nodes' edges
  std::set<std::string> proven_here_;  // names that are kept here, and were proven to be held here
  std::set<const char*> exceeded_;     // limits whose trouble was reported
  bool is_losing_ = false;             // participants leave now by their leases
  const Peer* looked_for_ = nullptr;   // whose process was looked for last, in one change
};

}  // namespace culprit::ros2
