// Which nodes depend on which: the live graph of the managed system (paper, "Knowledge base").
//
// A node depends on another if it subscribes to a topic that the other publishes, is a client of a
// service that the other serves, or is declared to depend on it. Nodes are joined through their
// channels (topics and services), so a channel with p producers and c consumers costs p + c, not p
// * c.
//
// Some topics carry no data that a node waits for: heartbeats (a topic called `bond`, as Nav2's servers
// and managers have one), and any topic that all its nodes both publish and subscribe to. They make no
// edges.
//
// The graph must not forget dependencies in a failure: a consumer still waits for a node that has
// exited. So a vanished end of a channel goes on counting while its node is gone. A vanished
// producer counts until another node produces on that channel. A change that a living node made (a
// subscription moved elsewhere) counts at once.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "knowledge/condensation.h"
#include "knowledge/known_robot.h"
#include "language/rule_set.h"
#include "robot/component_binding.h"
#include "robot/observation.h"

namespace culprit {

using NodeId = Id<struct NodeTag>;

class DependencyGraph {
 public:
  // More nodes, channels, or ends than this are not taken in: the network decides how many there
  // are.
  static constexpr std::size_t kMaxNodes = 20000;
  static constexpr std::size_t kMaxChannels = 100000;

  explicit DependencyGraph(const RuleSet& rules);

  // Each gives whether anything changed.
  bool node_appeared(const std::string& node);
  bool node_vanished(const std::string& node);
  bool endpoint_appeared(const std::string& node, EndpointKind kind, const std::string& name);
  bool endpoint_vanished(const std::string& node, EndpointKind kind, const std::string& name);

  // The ends that an earlier run saw of the component, which is not in the graph until it appears:
  // they count as if its node had been there and left.
  void remember(ComponentId component, const std::vector<KnownRobot::End>& ends);
  // The component's ends that count now.
  std::vector<KnownRobot::End> ends_of(ComponentId component) const;
  // Another number whenever a node or an end came or went.
  std::uint64_t changes() const { return changes_; }

  // A component with several nodes is present while all of them are.
  bool is_present(ComponentId component) const;
  // Any of its nodes is.
  bool has_any_node(ComponentId component) const;
  // The first of its nodes that is not there; empty: none is missing.
  std::string missing_node(ComponentId component) const;
  bool has_several_nodes(ComponentId component) const { return binding_.has_several(component); }
  // All nodes of the component: as when its process is known to be dead.
  void component_vanished(ComponentId component);
  // The full name of the component's node; empty while an undeclared one was not seen.
  const std::string& node_name(ComponentId component) const { return binding_.node_of(component); }
  // The component that this node is, if it is one.
  std::optional<ComponentId> component_of(const std::string& node) const;

  // While it is kept, ends that the component's node had count although it has none now: it is
  // being brought up, and makes them again later.
  void keep_ends(ComponentId component, bool is_kept);

  // Whether the component's node has all ends that count.
  bool has_all_ends(ComponentId component) const;

  // Whether it depends on any node, of the rules or not.
  bool reads_others(ComponentId component) const;

  // A topic that the component's node subscribes to, or a service that it is a client of, that no node
  // offers; the first by name. Empty: all that it reads is offered.
  std::optional<std::string> unsupplied_input(ComponentId component) const;

  // How many nodes publish `topic`, as far as was seen and is not ignored, and whether the
  // component is among them.
  std::size_t publisher_count(const std::string& topic) const;
  bool publishes(ComponentId component, const std::string& topic) const;
  // The component that alone publishes it; nothing if none or several do, or a node that is none.
  std::optional<ComponentId> only_publisher(const std::string& topic) const;
  // The same of a topic of the rules: of one with a FROM only that publisher counts.
  std::size_t publisher_count(const Topic& topic) const;
  bool publishes(ComponentId component, const Topic& topic) const;
  std::optional<ComponentId> only_publisher(const Topic& topic) const;
  // Nodes published it, and none does now.
  bool was_published(const std::string& topic) const;
  // Those that any node publishes now. Sorted.
  std::vector<std::string> published_topics() const;

  // The components that `component` depends on, directly or through any nodes between; not itself.
  // The reference is valid until the next call.
  const std::vector<ComponentId>& upstream(ComponentId component) const;
  // The components that depend on it, directly or through any nodes between; not itself.
  const std::vector<ComponentId>& downstream(ComponentId component) const;
  // For several components at once, in one search: those that any of them depends on, or that
  // depend on any of them, without themselves.
  const std::vector<ComponentId>& upstream(std::span<const ComponentId> components) const;
  const std::vector<ComponentId>& downstream(std::span<const ComponentId> components) const;
  // The first of upstream(), or downstream(), that is it, without a look at those behind it. `is_it`
  // does not search the graph.
  using Predicate = std::function<bool(ComponentId)>;
  std::optional<ComponentId> first_upstream(ComponentId component, const Predicate& is_it) const;
  std::optional<ComponentId> first_downstream(ComponentId component, const Predicate& is_it) const;

  // All that counts now, with each loop condensed. Found anew when it is asked for after a change
  // (docs/performance.md says what that costs); the reference is valid until the next change.
  const Condensation& condensation() const;
  // Empty while the component was not seen and is not declared to depend on another.
  std::optional<Condensation::Scc> scc_of(ComponentId component) const;

  using Vertex = std::uint32_t;
  // Nodes as numbers below size(). Empty as for scc_of().
  std::size_t size() const { return nodes_.size(); }
  std::optional<Vertex> vertex_of(ComponentId component) const {
    const auto node = nodes_of_components_[component.index];
    return node ? std::optional<Vertex>(node->index) : std::nullopt;
  }
  // Calls visit(producers, consumers) for each channel with both ends, and for each declared
  // dependency: spans of vertices, of all that counts now.
  template <class Visit>
  void for_each_channel(Visit visit) const;

  struct Edge {
    std::string consumer;
    std::string producer;
    std::string channel;  // topic or service; empty: declared
    bool operator==(const Edge&) const = default;
  };
  // For display: all nodes that are present, all dependencies that count. Sorted.
  std::vector<std::string> nodes() const;
  std::vector<Edge> edges() const;

 private:
  using ChannelId = Id<struct ChannelTag>;
  // One end of a channel. `count` endpoints of the node exist now; 0 = it is only remembered.
  struct End {
    NodeId node;
    std::uint32_t count = 0;
  };
  struct Node {
    std::string name;
    bool is_present = false;  // with all its names
    std::uint32_t names = 1;  // of a component with several nodes, which are one here: theirs
    bool keeps_ends = false;
    std::optional<ComponentId> component;
    std::vector<ChannelId> consumes;
    std::vector<ChannelId> produces;
    std::vector<NodeId> declared_producers;
    std::vector<NodeId> declared_consumers;
  };
  struct Channel {
    std::string name;
    bool is_service = false;
    bool is_heartbeat = false;  // by its name
    std::vector<End> producers;
    std::vector<End> consumers;
    std::uint32_t live_producers = 0;
  };
  enum class Direction : std::uint8_t { kUpstream, kDownstream };

  void declare(ComponentId consumer, ComponentId producer);
  NodeId add_node();
  // Makes one if the component has none. It gets its name when the node is seen.
  NodeId place_of(ComponentId component);
  End& end_of(NodeId node, ChannelId channel, bool producer);
  std::optional<NodeId> intern_node(const std::string& name);
  std::optional<ChannelId> intern_channel(EndpointKind kind, const std::string& name);
  bool counts(const End& end, const Channel& channel, bool producer) const;
  bool is_data_flow(const Channel& channel) const;
  std::vector<NodeId> publishers_of(const std::string& topic) const;
  // All that counts now, in one piece: a plan reads it several times.
  struct Whole {
    struct Link {  // a channel with both ends, or a declared dependency
      std::uint32_t producers;
      std::uint32_t consumers;
      std::uint32_t end;
    };
    std::vector<Vertex> ends;
    std::vector<Link> links;  // where each one's producers and consumers begin and end in `ends`
    std::optional<Condensation> condensation;
  };
  const Whole& whole() const;
  void find_links(Whole& whole) const;
  // Up to the first one that is `last`; null: all.
  const std::vector<ComponentId>& reach(std::span<const ComponentId> from, Direction direction,
                                        const Predicate& is_last = nullptr) const;
  std::optional<ComponentId> first(ComponentId from, Direction direction,
                                   const Predicate& is_it) const;

  ComponentBinding binding_;
  std::vector<Node> nodes_;
  std::vector<Channel> channels_;
  std::unordered_map<std::string, NodeId> node_ids_;
  std::unordered_set<std::string> parts_;  // nodes that are there, of components with several
  std::unordered_map<std::string, ChannelId> channel_ids_;  // key: 't' or 's', then the name
  std::vector<std::optional<NodeId>> nodes_of_components_;
  std::unordered_set<std::string> ignored_;

  std::uint64_t changes_ = 0;

  mutable std::optional<Whole> whole_;  // empty: something changed

  // Scratch of reach(): the search that visited each last; first the nodes, then the channels.
  mutable std::vector<std::uint32_t> visited_;
  mutable std::uint32_t search_ = 0;
  mutable std::vector<NodeId> frontier_;
  mutable std::vector<NodeId> producing_, consuming_;  // of is_data_flow()
  mutable std::vector<ComponentId> found_;
};

template <class Visit>
void DependencyGraph::for_each_channel(Visit visit) const {
  const std::span<const Vertex> ends(whole().ends);
  for (const Whole::Link& link : whole().links) {
    visit(ends.subspan(link.producers, link.consumers - link.producers),
          ends.subspan(link.consumers, link.end - link.consumers));
  }
}

}  // namespace culprit
