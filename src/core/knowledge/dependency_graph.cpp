#include "knowledge/dependency_graph.h"

#include <algorithm>
#include <tuple>

#include "base/invariant.h"
#include "base/ros_names.h"

namespace culprit {
namespace {

bool produces(EndpointKind kind) {
  return kind == EndpointKind::kPublisher || kind == EndpointKind::kServer;
}

bool is_service(EndpointKind kind) {
  return kind == EndpointKind::kServer || kind == EndpointKind::kClient;
}

}  // namespace

DependencyGraph::DependencyGraph(const RuleSet& rules)
    : binding_(rules), nodes_of_components_(rules.components.size()) {
  // Every node prints and announces parameters; none waits for another because of that.
  ignored_ = {"/rosout", "/parameter_events"};
  ignored_.insert(rules.ignored_topics.begin(), rules.ignored_topics.end());
  for (std::size_t c = 0; c < rules.components.size(); ++c) {
    if (!rules.components[c].node.empty()) intern_node(rules.components[c].node);
    for (const std::string& other : rules.components[c].other_nodes) intern_node(other);
  }
  for (const Dependency& d : rules.dependencies) declare(d.consumer, d.producer);
  // A component ends with its container.
  for (std::size_t c = 0; c < rules.components.size(); ++c) {
    const ComponentId component(c);
    if (const auto container = container_of(component, rules)) declare(component, *container);
  }
}

void DependencyGraph::declare(ComponentId consumer, ComponentId producer) {
  const NodeId from = place_of(consumer);
  const NodeId to = place_of(producer);
  std::vector<NodeId>& known = nodes_[from.index].declared_producers;
  if (from == to || std::ranges::find(known, to) != known.end()) return;
  known.push_back(to);
  nodes_[to.index].declared_consumers.push_back(from);
}

NodeId DependencyGraph::add_node() {
  nodes_.emplace_back();
  whole_.reset();
  return NodeId(nodes_.size() - 1);
}

NodeId DependencyGraph::place_of(ComponentId component) {
  auto& node = nodes_of_components_[component.index];
  if (!node) {
    node = add_node();
    nodes_.back().component = component;
  }
  return *node;
}

std::optional<NodeId> DependencyGraph::intern_node(const std::string& name) {
  const auto known = node_ids_.find(name);
  if (known != node_ids_.end()) return known->second;
  if (nodes_.size() >= kMaxNodes) return std::nullopt;

  const std::optional<ComponentId> component = binding_.bind(name);
  std::optional<NodeId> id;
  if (component) id = nodes_of_components_[component->index];
  if (!id) id = add_node();
  const bool is_other = component && binding_.node_of(*component) != name;
  if (is_other) {
    ++nodes_[id->index].names;
  } else {
    nodes_[id->index].name = name;
  }
  nodes_[id->index].component = component;
  if (component) nodes_of_components_[component->index] = id;
  node_ids_[name] = *id;
  return id;
}

std::optional<DependencyGraph::ChannelId> DependencyGraph::intern_channel(EndpointKind kind,
                                                                          const std::string& name) {
  const std::string key = (is_service(kind) ? 's' : 't') + name;
  const auto known = channel_ids_.find(key);
  if (known != channel_ids_.end()) return known->second;
  if (channels_.size() >= kMaxChannels) return std::nullopt;
  const ChannelId id(channels_.size());
  const bool is_heartbeat = !is_service(kind) && own_name(name) == "bond";
  channels_.push_back({name, is_service(kind), is_heartbeat, {}, {}, 0});
  channel_ids_[key] = id;
  return id;
}

bool DependencyGraph::node_appeared(const std::string& node) {
  const auto id = intern_node(node);
  if (!id || nodes_[id->index].is_present) return false;
  Node& here = nodes_[id->index];
  if (here.names > 1) {
    parts_.insert(node);
    if (!missing_node(*here.component).empty()) return false;
  }
  whole_.reset();
  ++changes_;
  return here.is_present = true;
}

bool DependencyGraph::node_vanished(const std::string& node) {
  const auto id = node_ids_.find(node);
  parts_.erase(node);
  if (id == node_ids_.end() || !nodes_[id->second.index].is_present) return false;
  nodes_[id->second.index].is_present = false;
  ++changes_;
  whole_.reset();
  return true;
}

void DependencyGraph::component_vanished(ComponentId component) {
  node_vanished(binding_.node_of(component));
  for (const std::string& other : binding_.other_nodes(component)) node_vanished(other);
}

bool DependencyGraph::has_any_node(ComponentId component) const {
  if (!has_several_nodes(component)) return is_present(component);
  return parts_.contains(binding_.node_of(component)) ||
         std::ranges::any_of(binding_.other_nodes(component),
                             [&](const std::string& other) { return parts_.contains(other); });
}

std::string DependencyGraph::missing_node(ComponentId component) const {
  if (!has_several_nodes(component))
    return is_present(component) ? "" : binding_.node_of(component);
  if (!parts_.contains(binding_.node_of(component))) return binding_.node_of(component);
  for (const std::string& other : binding_.other_nodes(component)) {
    if (!parts_.contains(other)) return other;
  }
  return "";
}

void DependencyGraph::keep_ends(ComponentId component, bool is_kept) {
  const auto node = nodes_of_components_[component.index];
  if (!node || nodes_[node->index].keeps_ends == is_kept) return;
  nodes_[node->index].keeps_ends = is_kept;
  ++changes_;
  whole_.reset();
}

bool DependencyGraph::has_all_ends(ComponentId component) const {
  const auto node = nodes_of_components_[component.index];
  if (!node) return true;
  const auto is_there = [&](const std::vector<End>& ends) {
    return std::none_of(ends.begin(), ends.end(),
                        [&](const End& e) { return e.node == *node && e.count == 0; });
  };
  const Node& here = nodes_[node->index];
  return std::all_of(here.produces.begin(), here.produces.end(),
                     [&](ChannelId id) { return is_there(channels_[id.index].producers); }) &&
         std::all_of(here.consumes.begin(), here.consumes.end(),
                     [&](ChannelId id) { return is_there(channels_[id.index].consumers); });
}

bool DependencyGraph::endpoint_appeared(const std::string& node, EndpointKind kind,
                                        const std::string& name) {
  if (!is_service(kind) && ignored_.contains(name)) return false;
  const auto node_id = intern_node(node);
  const auto channel_id = intern_channel(kind, name);
  if (!node_id || !channel_id) return false;
  if (++end_of(*node_id, *channel_id, produces(kind)).count > 1) return false;
  if (produces(kind)) ++channels_[channel_id->index].live_producers;
  whole_.reset();
  ++changes_;
  return true;
}

DependencyGraph::End& DependencyGraph::end_of(NodeId node, ChannelId channel, bool producer) {
  auto& ends = producer ? channels_[channel.index].producers : channels_[channel.index].consumers;
  const auto end =
      std::find_if(ends.begin(), ends.end(), [&](const End& e) { return e.node == node; });
  if (end != ends.end()) return *end;
  Node& owner = nodes_[node.index];
  (producer ? owner.produces : owner.consumes).push_back(channel);
  return ends.emplace_back(End{node, 0});
}

void DependencyGraph::remember(ComponentId component, const std::vector<KnownRobot::End>& ends) {
  const NodeId node = place_of(component);
  for (const KnownRobot::End& end : ends) {
    if (!is_service(end.kind) && ignored_.contains(end.name)) continue;
    const auto channel = intern_channel(end.kind, end.name);
    if (!channel) return;
    end_of(node, *channel, produces(end.kind));
    whole_.reset();
  }
}

std::vector<KnownRobot::End> DependencyGraph::ends_of(ComponentId component) const {
  std::vector<KnownRobot::End> found;
  const auto node = nodes_of_components_[component.index];
  if (!node) return found;
  const auto add = [&](ChannelId id, bool producer) {
    const Channel& channel = channels_[id.index];
    const auto& ends = producer ? channel.producers : channel.consumers;
    const auto own =
        std::find_if(ends.begin(), ends.end(), [&](const End& e) { return e.node == *node; });
    CULPRIT_ASSERT(own != ends.end());
    if (!counts(*own, channel, producer)) return;
    const EndpointKind of_topic = producer ? EndpointKind::kPublisher : EndpointKind::kSubscriber;
    const EndpointKind of_service = producer ? EndpointKind::kServer : EndpointKind::kClient;
    found.push_back({channel.is_service ? of_service : of_topic, channel.name});
  };
  for (const ChannelId channel : nodes_[node->index].produces) add(channel, true);
  for (const ChannelId channel : nodes_[node->index].consumes) add(channel, false);
  return found;
}

bool DependencyGraph::endpoint_vanished(const std::string& node, EndpointKind kind,
                                        const std::string& name) {
  const auto node_id = node_ids_.find(node);
  const auto channel_id = channel_ids_.find((is_service(kind) ? 's' : 't') + name);
  if (node_id == node_ids_.end() || channel_id == channel_ids_.end()) return false;
  Channel& channel = channels_[channel_id->second.index];
  auto& ends = produces(kind) ? channel.producers : channel.consumers;
  const auto end = std::find_if(ends.begin(), ends.end(),
                                [&](const End& e) { return e.node == node_id->second; });
  if (end == ends.end() || end->count == 0) return false;
  if (--end->count > 0) return false;
  // Below zero, a topic whose last publisher is gone would count as published.
  CULPRIT_ASSERT(!produces(kind) || channel.live_producers > 0);
  if (produces(kind)) --channel.live_producers;
  whole_.reset();
  ++changes_;
  return true;
}

std::vector<NodeId> DependencyGraph::publishers_of(const std::string& topic) const {
  std::vector<NodeId> nodes;
  const auto known = channel_ids_.find('t' + topic);
  if (known == channel_ids_.end()) return nodes;
  const Channel& channel = channels_[known->second.index];
  for (const End& end : channel.producers) {
    if (counts(end, channel, true)) nodes.push_back(end.node);
  }
  return nodes;
}

std::size_t DependencyGraph::publisher_count(const std::string& topic) const {
  return publishers_of(topic).size();
}

bool DependencyGraph::publishes(ComponentId component, const std::string& topic) const {
  const auto node = nodes_of_components_[component.index];
  const std::vector<NodeId> publishers = publishers_of(topic);
  return node && std::find(publishers.begin(), publishers.end(), *node) != publishers.end();
}

std::optional<ComponentId> DependencyGraph::only_publisher(const std::string& topic) const {
  const std::vector<NodeId> publishers = publishers_of(topic);
  return publishers.size() == 1 ? nodes_[publishers.front().index].component : std::nullopt;
}

std::size_t DependencyGraph::publisher_count(const Topic& topic) const {
  if (!topic.publisher) return publisher_count(topic.name);
  return publishes(*topic.publisher, topic.name) ? 1 : 0;
}

bool DependencyGraph::publishes(ComponentId component, const Topic& topic) const {
  return (!topic.publisher || *topic.publisher == component) && publishes(component, topic.name);
}

std::optional<ComponentId> DependencyGraph::only_publisher(const Topic& topic) const {
  if (!topic.publisher) return only_publisher(topic.name);
  return publishes(*topic.publisher, topic.name) ? topic.publisher : std::nullopt;
}

bool DependencyGraph::was_published(const std::string& topic) const {
  const auto known = channel_ids_.find('t' + topic);
  if (known == channel_ids_.end()) return false;
  const auto& producers = channels_[known->second.index].producers;
  return !producers.empty() && std::none_of(producers.begin(), producers.end(), [&](const End& e) {
    return e.count > 0 && nodes_[e.node.index].is_present;
  });
}

std::vector<std::string> DependencyGraph::published_topics() const {
  std::vector<std::string> topics;
  for (const Channel& channel : channels_) {
    if (!channel.is_service && channel.live_producers > 0) topics.push_back(channel.name);
  }
  std::sort(topics.begin(), topics.end());
  return topics;
}

bool DependencyGraph::counts(const End& end, const Channel& channel, bool producer) const {
  const Node& node = nodes_[end.node.index];
  if (end.count > 0 || !node.is_present || node.keeps_ends) return true;
  return producer && channel.live_producers == 0;
}

bool DependencyGraph::is_data_flow(const Channel& channel) const {
  if (channel.is_heartbeat) return false;
  if (channel.is_service) return true;
  const auto collect = [&](const std::vector<End>& ends, bool are_producers,
                           std::vector<NodeId>& nodes) {
    nodes.clear();
    for (const End& end : ends) {
      if (counts(end, channel, are_producers)) nodes.push_back(end.node);
    }
    std::ranges::sort(nodes);
  };
  collect(channel.producers, true, producing_);
  if (producing_.size() < 2) return true;
  collect(channel.consumers, false, consuming_);
  return producing_ != consuming_;
}

std::optional<std::string> DependencyGraph::unsupplied_input(ComponentId component) const {
  const auto node = nodes_of_components_[component.index];
  std::optional<std::string> first;
  if (!node) return first;
  for (const ChannelId id : nodes_[node->index].consumes) {
    const Channel& channel = channels_[id.index];
    if (channel.is_heartbeat) continue;
    const bool is_supplied =
        std::any_of(channel.producers.begin(), channel.producers.end(),
                    [&](const End& end) { return counts(end, channel, true); });
    if (!is_supplied && (!first || channel.name < *first)) first = channel.name;
  }
  return first;
}

bool DependencyGraph::is_present(ComponentId component) const {
  const auto node = nodes_of_components_[component.index];
  return node && nodes_[node->index].is_present;
}

std::optional<ComponentId> DependencyGraph::component_of(const std::string& node) const {
  const auto id = node_ids_.find(node);
  return id == node_ids_.end() ? std::nullopt : nodes_[id->second.index].component;
}

const std::vector<ComponentId>& DependencyGraph::upstream(ComponentId component) const {
  return reach(std::span(&component, 1), Direction::kUpstream);
}

const std::vector<ComponentId>& DependencyGraph::upstream(
    std::span<const ComponentId> components) const {
  return reach(components, Direction::kUpstream);
}

bool DependencyGraph::reads_others(ComponentId component) const {
  const auto node = nodes_of_components_[component.index];
  if (!node) return false;
  const Node& own = nodes_[node->index];
  return !own.declared_producers.empty() || std::ranges::any_of(own.consumes, [&](ChannelId id) {
    const Channel& channel = channels_[id.index];
    const auto end = std::ranges::find(channel.consumers, *node, &End::node);
    CULPRIT_ASSERT(end != channel.consumers.end());
    return is_data_flow(channel) && counts(*end, channel, false) &&
           std::ranges::any_of(channel.producers, [&](const End& each) {
             return each.node != *node && counts(each, channel, true);
           });
  });
}

const std::vector<ComponentId>& DependencyGraph::downstream(ComponentId component) const {
  return reach(std::span(&component, 1), Direction::kDownstream);
}

const std::vector<ComponentId>& DependencyGraph::downstream(
    std::span<const ComponentId> components) const {
  return reach(components, Direction::kDownstream);
}

std::optional<ComponentId> DependencyGraph::first_upstream(ComponentId component,
                                                           const Predicate& is_it) const {
  return first(component, Direction::kUpstream, is_it);
}

std::optional<ComponentId> DependencyGraph::first_downstream(ComponentId component,
                                                             const Predicate& is_it) const {
  return first(component, Direction::kDownstream, is_it);
}

std::optional<ComponentId> DependencyGraph::first(ComponentId from, Direction direction,
                                                  const Predicate& is_it) const {
  std::optional<ComponentId> found;
  reach(std::span(&from, 1), direction, [&](ComponentId each) {
    if (is_it(each)) found = each;
    return found.has_value();
  });
  return found;
}

const std::vector<ComponentId>& DependencyGraph::reach(std::span<const ComponentId> from,
                                                       Direction direction,
                                                       const Predicate& is_last) const {
  found_.clear();
  frontier_.clear();
  visited_.resize(nodes_.size() + channels_.size(), 0);
  ++search_;
  for (const ComponentId each : from) {
    const auto start = nodes_of_components_[each.index];
    if (!start || visited_[start->index] == search_) continue;
    visited_[start->index] = search_;
    frontier_.push_back(*start);
  }
  // Gives whether that was the last one.
  const auto visit = [&](NodeId node) {
    if (visited_[node.index] == search_) return false;
    visited_[node.index] = search_;
    frontier_.push_back(node);
    const auto& component = nodes_[node.index].component;
    if (!component) return false;
    found_.push_back(*component);
    return is_last && is_last(*component);
  };
  const bool up = direction == Direction::kUpstream;
  while (!frontier_.empty()) {
    const NodeId id = frontier_.back();
    const Node& here = nodes_[id.index];
    frontier_.pop_back();
    for (const NodeId declared : up ? here.declared_producers : here.declared_consumers) {
      if (visit(declared)) return found_;
    }
    for (const ChannelId channel_id : up ? here.consumes : here.produces) {
      // The search passes each channel once, however many nodes share it.
      std::uint32_t& passed = visited_[nodes_.size() + channel_id.index];
      if (passed == search_) continue;
      const Channel& channel = channels_[channel_id.index];
      if (!is_data_flow(channel)) {
        passed = search_;
        continue;
      }
      const auto& near = up ? channel.consumers : channel.producers;
      const auto own =
          std::find_if(near.begin(), near.end(), [&](const End& e) { return e.node == id; });
      CULPRIT_ASSERT(own != near.end());  // a cause would be sought along a channel that is not its
      if (!counts(*own, channel, !up)) continue;
      passed = search_;
      for (const End& far : up ? channel.producers : channel.consumers) {
        if (counts(far, channel, up) && visit(far.node)) return found_;
      }
    }
  }
  return found_;
}

void DependencyGraph::find_links(Whole& whole) const {
  whole.links.reserve(channels_.size());
  auto& ends = whole.ends;
  const auto end = [&] { return static_cast<std::uint32_t>(ends.size()); };
  for (Vertex n = 0; n < nodes_.size(); ++n) {
    for (const NodeId producer : nodes_[n].declared_producers) {
      whole.links.push_back({end(), end() + 1, end() + 2});
      ends.push_back(producer.index);
      ends.push_back(n);
    }
  }
  for (const Channel& channel : channels_) {
    if (!is_data_flow(channel)) continue;
    Whole::Link link{end(), 0, 0};
    for (const End& each : channel.producers) {
      if (counts(each, channel, true)) ends.push_back(each.node.index);
    }
    link.consumers = end();
    for (const End& each : channel.consumers) {
      if (counts(each, channel, false)) ends.push_back(each.node.index);
    }
    link.end = end();
    if (link.producers < link.consumers && link.consumers < link.end) {
      whole.links.push_back(link);
    } else {
      ends.resize(link.producers);
    }
  }
}

const DependencyGraph::Whole& DependencyGraph::whole() const {
  if (whole_) return *whole_;
  Whole& whole = whole_.emplace();
  find_links(whole);
  ChannelEdges edges(nodes_.size());
  edges.reserve(whole.ends.size());
  for_each_channel([&](auto producers, auto consumers) { edges.add(producers, consumers); });
  whole.condensation.emplace(edges.vertices(), edges.edges());
  return whole;
}

const Condensation& DependencyGraph::condensation() const { return *whole().condensation; }

std::optional<Condensation::Scc> DependencyGraph::scc_of(ComponentId component) const {
  const auto node = vertex_of(component);
  if (!node) return std::nullopt;
  return condensation().scc_of(*node);
}

std::vector<std::string> DependencyGraph::nodes() const {
  std::vector<std::string> names;
  for (const Node& node : nodes_) {
    if (node.is_present) names.push_back(node.name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<DependencyGraph::Edge> DependencyGraph::edges() const {
  std::vector<Edge> edges;
  for (const Channel& channel : channels_) {
    if (!is_data_flow(channel)) continue;
    for (const End& consumer : channel.consumers) {
      for (const End& producer : channel.producers) {
        if (consumer.node == producer.node) continue;
        if (!counts(consumer, channel, false) || !counts(producer, channel, true)) continue;
        edges.push_back(
            {nodes_[consumer.node.index].name, nodes_[producer.node.index].name, channel.name});
      }
    }
  }
  for (const Node& node : nodes_) {
    for (const NodeId producer : node.declared_producers)
      edges.push_back({node.name, nodes_[producer.index].name, ""});
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.consumer, a.producer, a.channel) <
           std::tie(b.consumer, b.producer, b.channel);
  });
  return edges;
}

}  // namespace culprit
