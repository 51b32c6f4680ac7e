#include "link/link.h"

#include <algorithm>
#include <array>
#include <malloc.h>
#include <set>

#include "base/environment.h"
#include "base/live_clock.h"
#include "base/tool_names.h"
#include "link/named_process.h"
#include "link/simulated_clock.h"
#include "ros2/helper_options.h"
#include "ros2/process_finder.h"
#include "ros2/services.h"

namespace culprit::link {
namespace {

constexpr Duration kProbePeriod = std::chrono::milliseconds(400);
constexpr Duration kPublishPeriod = std::chrono::seconds(1);
// So long after the robot changed, the memory for that is given back.
constexpr auto kGivesBack = std::chrono::seconds(10);

// Services that managers and tools use, of every node or of every managed node: their users depend
// on no node by them.
bool is_for_management(std::string_view service) {
  constexpr std::array<std::string_view, 17> kNames = {
      "get_parameters",       "get_parameter_types",
      "set_parameters",       "set_parameters_atomically",
      "describe_parameters",  "list_parameters",
      "change_state",         "get_state",
      "get_available_states", "get_available_transitions",
      "get_transition_graph", "get_type_description",
      "get_logger_levels",    "set_logger_levels",
      "change_mode",          "get_mode",
      "get_available_modes"};
  const std::string_view last = service.substr(service.rfind('/') + 1);
  return std::find(kNames.begin(), kNames.end(), last) != kNames.end();
}

bool is_service(EndpointKind kind) {
  return kind == EndpointKind::kServer || kind == EndpointKind::kClient;
}

}  // namespace

Expected<std::unique_ptr<Link>> Link::open(const RuleSet& rules, Options options, Inbox& inbox) {
  std::unique_ptr<Link> link(new Link(rules, std::move(options), inbox));
  if (auto started = link->start(); !started) return Error{started.error()};
  return link;
}

Link::Link(const RuleSet& rules, Options options, Inbox& inbox)
    : rules_(rules),
      options_(std::move(options)),
      inbox_(inbox),
      binding_(rules),
      leaving_(
          executor_, inbox,
          [this](const std::string& node, LeavingAnnouncements::Then then) {
            ask(node, std::move(then));
          },
          [this](const std::string& node, bool was_lost) { vanished(node, was_lost); }),
      links_(rules.components.size()) {}

Link::~Link() {
  executor_.stop();
  if (thread_.joinable()) thread_.join();
  // Clients and readers go before the node that they belong to.
  tasks_.close();
  listening_.reset();
  other_nodes_.reset();
  probing_.reset();
  publishing_.reset();
  lease_.reset();
  hearing_.reset();
  parameter_watch_.reset();
  diagnostics_watch_.reset();
  log_watch_.reset();
  time_.reset();
  watches_.clear();
  links_.clear();
  diagnostics_.reset();
  types_.reset();
  node_.reset();
  context_.reset();
}

Expected<void> Link::start() {
  if (auto joined = join(); !joined) return joined;
  if (auto watched = watch(); !watched) return watched;
  auto hearing = ros2::Hearing::begin(context_->participant(), executor_);
  if (!hearing) return Error{hearing.error()};
  hearing_ = std::move(*hearing);
  if (options_.lease) {
    auto lease = LeaseLink::open(*context_, *hearing_, executor_, *options_.lease);
    if (!lease) return Error{lease.error()};
    lease_ = std::move(*lease);
  }
  publishing_ = std::make_unique<ros2::Timer>(executor_, kPublishPeriod, [this] {
    publish_again();
    datagrams_->tell(live_now());
    remind();
    listen_to_hosts();
    look_at_hosts();
    tell_usage();
    time_->report();
  });
  probing_ = std::make_unique<ros2::Timer>(executor_, kProbePeriod, [this] { probe(); });
  thread_ = std::thread([this] { executor_.run(); });
  return {};
}

ros2::Graph::Options Link::graph_options() {
  ros2::Graph::Options graph;
  graph.listener = [this](const ros2::GraphChange& change) { on_change(change); };
  graph.find_process = [this,
                        finder = ros2::ProcessFinder()](const ros2::ParticipantInfo& participant) {
    return options_.participant.helper ? find_named(participant) : finder.find(participant);
  };
  graph.is_running = [finder = ros2::ProcessFinder()](int pid) { return finder.is_running(pid); };
  graph.is_ended_by_others = [this](const std::string& node) {
    const auto component = binding_.bind(node);
    return component && rules_[*component].has_owner();
  };
  graph.is_component = [this](const std::string& node) { return binding_.find(node).has_value(); };
  graph.is_kept_here = [this](const std::string& node) {
    const auto component = binding_.bind(node);
    if (!component) return false;
    const Component& declared = rules_[*component];
    return (!declared.launch.empty() || declared.composed) && !declared.has_owner();
  };
  graph.is_asked_about = [this](const std::string& node) {
    const auto component = binding_.bind(node);
    return component && leaving_.is_doubted(*component, node);
  };
  return graph;
}

// As a node of the domain.
Expected<void> Link::join() {
  if (options_.participant.helper) {
    auto helper = std::make_shared<ros2::HelperOptions>(*options_.participant.helper);
    helper->name_space = options_.name.name_space;
    helper->name = options_.name.name;
    helper->on_trouble = [this](std::string text) { inbox_.put(LinkTrouble{std::move(text)}); };
    options_.participant.helper = std::move(helper);
  }
  // Another computer may be off, or the network not up yet.
  options_.participant.on_missing_peer = [this](const std::string& why) {
    inbox_.put(
        LinkTrouble{why + "; culprit goes without it. Correct ROS_STATIC_PEERS, or restart culprit "
                          "once that computer is reachable"});
  };
  auto context = ros2::Context::create(executor_, options_.participant, graph_options());
  if (!context) return Error{context.error()};
  context_ = std::move(*context);
  context_->participant().on_round([this] { inbox_.hand_over(); });
  datagrams_.emplace(*context_, inbox_, options_.participant.helper != nullptr);
  context_->on_discovery([this](const ros2::DiscoveryEvent& event) { on_discovery(event); });
  leaving_.watch(*context_);
  hosts_ = std::make_unique<ComponentHosts>(
      [this](const rtps::GuidPrefix& participant) {
        return context_->participant().heard_last(participant);
      },
      inbox_);
  auto node = ros2::Node::create(*context_, options_.name);
  if (!node) return Error{node.error()};
  node_ = std::move(*node);
  types_ = std::make_unique<TypeFinder>(*node_, options_.types);
  other_nodes_ = std::make_unique<OtherNodes>(node_->entry(), binding_, inbox_);
  listening_ = std::make_unique<ListeningProof>(node_->entry(), executor_, inbox_,
                                                [this] { return silent_topics(); });
  auto publisher = node_->create_publisher<ros2::msg::DiagnosticArray>("/diagnostics");
  if (!publisher) return Error{publisher.error()};
  diagnostics_.emplace(std::move(*publisher));
  return declare_parameters();
}

// Subscribes to what the rules read.
Expected<void> Link::watch() {
  for (std::size_t t = 0; t < rules_.topics.size(); ++t) {
    const std::string& name = rules_.topics[t].name;
    if (watches_.contains(name)) continue;
    auto watch = std::make_unique<TopicWatch>(node_->entry(), TopicId(t), rules_, inbox_);
    watch->asks_for_writers([this, name] { tasks_.post([this, name] { tell_writers(name); }); });
    watches_.emplace(name, std::move(watch));
  }
  const auto bind = [this](const std::string& name) { return binding_.bind(name); };
  auto diagnostics = DiagnosticsWatch::create(node_->entry(), rules_, inbox_, bind);
  if (!diagnostics) return Error{diagnostics.error()};
  diagnostics_watch_ = std::move(*diagnostics);
  auto log = LogWatch::create(node_->entry(), rules_, inbox_, bind);
  if (!log) return Error{log.error()};
  log_watch_ = std::move(*log);
  for (const Input& input : rules_.inputs) {
    if (input.kind == Input::Kind::kCpu || input.kind == Input::Kind::kMemory)
      meters_.try_emplace(input.component);
  }
  time_ = std::make_unique<RobotTime>(node_->entry(), *context_, inbox_);
  if (options_.use_sim_time) {
    if (auto followed = time_->follow_for_all(); !followed) return followed;
  }
  if (rules_.parameters.empty()) return {};
  parameter_watch_ = std::make_unique<ParameterWatch>(
      *context_, executor_, rules_, inbox_, binding_, *other_nodes_, [this](ComponentId component) {
        if (ComponentLink* link = link_of(component)) link->check_values();
      });
  return parameter_watch_->start(node_->entry());
}

// Within a change of the graph.
ros2::FoundProcess Link::find_named(const ros2::ParticipantInfo& participant) const {
  if (!participant.host.empty() && participant.host != host_name()) return {};
  std::vector<NamedProcess::Sought> nodes;
  for (const std::string& node : participant.nodes) {
    NamedProcess::Sought& sought = nodes.emplace_back(NamedProcess::Sought{node});
    const auto component = binding_.find(node);
    if (!component) continue;
    sought.launch = rules_[*component].launch;
    if (!rules_[*component].composed)
      sought.mark = std::to_string(options_.participant.domain) + "/" + rules_.robot + "/" +
                    rules_[*component].name;
  }
  return NamedProcess().find(participant, nodes);
}

Time Link::sure_to_hear(Time now) const {
  const Time heard = hearing_->doubtful();
  return lease_ ? std::min(heard, lease_->sure_until(now)) : heard;
}

Time Link::doubtful() const {
  const Time now = live_now();
  return std::min(sure_to_hear(now), time_->doubtful(now));
}

bool Link::is_paused() const {
  const Time now = live_now();
  return sure_to_hear(now) > now && time_->doubtful(now) <= now;
}

std::string Link::doubt() const {
  const Time now = live_now();
  if (is_paused()) return time_->doubt(now);
  if (lease_ && lease_->sure_until(now) <= now)
    return "culprit did not run for so long that another one may manage this robot now; culprit "
           "waits for its messages";
  return options_.participant.helper ? "the helper program of --link ros does not answer"
                                     : hearing_->doubt(now);
}

Expected<void> Link::declare_parameters() {
  for (const auto& [name, value] : options_.parameters) {
    ros2::msg::ParameterDescriptor descriptor;
    descriptor.read_only = true;
    if (auto declared = node_->parameters().declare(name, value, descriptor); !declared)
      return declared;
  }
  return {};
}

// To discover a robot takes more memory than to know it, and the allocator keeps what is free between what is not. Once for
// all that changes within a while.
void Link::give_memory_back_soon() {
  if (std::exchange(gives_memory_back_, true)) return;
  tasks_.post_at(ros2::Executor::Clock::now() + kGivesBack, [this] {
    gives_memory_back_ = false;
    malloc_trim(0);
  });
}

// ---- observations

void Link::on_change(const ros2::GraphChange& change) {
  give_memory_back_soon();
  if (const auto* joined = std::get_if<ros2::NodeJoined>(&change)) {
    on_joined(joined->node);
  } else if (const auto* left = std::get_if<ros2::NodeLeft>(&change)) {
    on_left(left->node, left->was_lost);
  } else if (const auto* endpoint = std::get_if<ros2::EndpointJoined>(&change)) {
    on_endpoint(endpoint->node, endpoint->endpoint);
  } else if (const auto* gone = std::get_if<ros2::EndpointLeft>(&change)) {
    if (gone->kind == EndpointKind::kSubscriber) on_subscription(gone->node, gone->name);
    if (is_service(gone->kind) && is_for_management(gone->name)) return;
    inbox_.put(EndpointVanished{gone->node, gone->kind, gone->name});
  } else if (const auto* namesakes = std::get_if<ros2::NodeNamesakes>(&change)) {
    // Before anybody acts on it. Rules may have nothing to complain of, or complain late: this is
    // reported in its own right.
    contests_.seen(*namesakes, is_ours(namesakes->node), live_now());
    inbox_.put(NamesakesSeen{namesakes->node, namesakes->others});
  } else if (const auto* doubted = std::get_if<ros2::NodeSaidToLeave>(&change)) {
    leaving_.said_to_leave(doubted->node);
  } else if (const auto* trouble = std::get_if<ros2::GraphTrouble>(&change)) {
    inbox_.put(LinkTrouble{trouble->text});
  }
}

void Link::on_discovery(const ros2::DiscoveryEvent& event) {
  hosts_->on_discovery(event);
  if (lease_) lease_->on_discovery(event);
}

// If culprit was deaf, or stood still, it missed messages meanwhile.
void Link::listen_to_hosts() {
  const Time now = live_now();
  const bool stood_still = later(looked_at_hosts_, 2 * kPublishPeriod) < now;
  if (sure_to_hear(now) <= now || stood_still) hosts_->listens_from(now);
  looked_at_hosts_ = now;
}

// A component's node, or a container that one is in.
bool Link::is_ours(const std::string& node) {
  const bool is_container = std::ranges::any_of(rules_.components, [&](const Component& c) {
    return c.composed && c.composed->container == node;
  });
  return is_container || binding_.bind(node).has_value();
}

std::optional<std::string> Link::cut_off(ComponentId component) {
  look_at_hosts();
  return hosts_->cut_off(component);
}

void Link::look_at_hosts() {
  const Time now = live_now();
  if (sure_to_hear(now) <= now) return;
  for (const ComponentId component : hosts_->look(now)) {
    if (ComponentLink* link = link_of(component)) link->forget_unanswered();
  }
}

void Link::remind() {
  const Time now = live_now();
  for (std::string& text : contests_.due(now)) inbox_.put(LinkTrouble{std::move(text)});
  if (auto text = namesake_.due(now)) inbox_.put(LinkTrouble{std::move(*text)});
}

void Link::on_joined(const ros2::GraphNode& node) {
  const std::string host = node.pid == 0 ? printable(node.host) : "";
  hosts_->node_joined(node.name, host);
  inbox_.put(NodeAppeared{node.name, node.pid});
  diagnostics_watch_->node_joined(node.name);
  if (node.name == node_->name().full()) namesake_.joined(node, live_now());
  mode_managers_.node_joined(node.name);
  leaving_.is_back(node.name);
  const auto component = binding_.bind(node.name);
  if (!component) return;
  leaving_.joined(node);
  if (other_nodes_->has(*component, node.name)) return other_nodes_->joined(*component, node);
  make_link(*component, node.name)->lives_in(node.pid, node.participant);
  hosts_->lives_on(*component, host);
  if (node.pid == 0 || needs_of(*component, rules_).is_to_answer) {
    probed_[node.name] = {*component, node.pid};
  } else {
    probed_.erase(node.name);
  }
}

void Link::on_left(const std::string& node, bool was_lost) {
  hosts_->node_left(node);
  other_nodes_->left(node);
  probed_.erase(node);
  diagnostics_watch_->node_left(node);
  mode_managers_.node_left(node);
  if (node == node_->name().full()) namesake_.left();
  leaving_.left(node, was_lost);
}

// Whether the node is there, and which participant answers for it. The middleware may know its
// services still, if a message in its name announced only that it holds no node.
void Link::ask(const std::string& node, LeavingAnnouncements::Then then) {
  const auto component = binding_.bind(node);
  if (!component) return then(std::nullopt);
  if (other_nodes_->has(*component, node)) return other_nodes_->ask(node, std::move(then));
  make_link(*component, node)->ask(std::move(then));
}

void Link::vanished(const std::string& node, bool was_lost) {
  const auto component = was_lost ? std::nullopt : binding_.bind(node);
  if (component && !other_nodes_->has(*component, node)) hosts_->lives_on(*component, "");
  for (const std::string& system : mode_managers_.systems_gone_with(node))
    inbox_.put(NodeVanished{system});
  inbox_.put(NodeVanished{node});
}

void Link::remember_publishers(const std::map<std::string, std::string>& publishers) {
  for (const auto& [status, node] : publishers) diagnostics_watch_->remember(status, node);
}

// A system of system_modes is no node: its mode manager offers its services, and it is there as
// long as the manager is. It offers the same for nodes that have modes, which are there by
// themselves.
void Link::on_system(const std::string& manager, const ros2::GraphEndpoint& service) {
  const std::string system = service.name.substr(0, service.name.rfind('/'));
  const auto component = binding_.bind(system);
  if (system == manager || !component || rules_[*component].node != system) return;
  const ros2::Graph& graph = context_->graph();
  if (!mode_managers_.may_tell(manager, system, graph)) return;
  if (!graph.node(system)) {
    mode_managers_.represents(manager, system);
    inbox_.put(NodeAppeared{system, graph.process_of(manager)});
  }
  ComponentLink* link = make_link(*component, system);
  link->modes_come_from(participant_of(manager));
  link->service_seen(service);
}

void Link::on_endpoint(const std::string& node, const ros2::GraphEndpoint& endpoint) {
  if (endpoint.kind == EndpointKind::kServer) {
    const auto component = binding_.bind(node);
    const bool is_main = component && !other_nodes_->has(*component, node);
    if (is_main && endpoint.name == node + "/change_mode")
      make_link(*component, node)->modes_come_from(participant_of(node));
    if (is_main) make_link(*component, node)->service_seen(endpoint);
    // A secured domain need not allow that question.
    const bool is_to_be_asked = is_main && !options_.use_sim_time &&
                                !options_.participant.security &&
                                endpoint.name == node + "/get_parameters";
    if (is_to_be_asked) {
      make_link(*component, node)->ask_time_source([this, node, component](bool is_simulated) {
        tasks_.post([this, node, component, is_simulated] {
          time_->learned(*component, node, is_simulated);
        });
      });
    }
    if (endpoint.type == ros2::srv::ChangeMode::kType) on_system(node, endpoint);
  }
  if (endpoint.kind == EndpointKind::kSubscriber) on_subscription(node, endpoint.name);
  if (endpoint.kind == EndpointKind::kPublisher) {
    const auto watch = watches_.find(endpoint.name);
    if (watch != watches_.end()) find_type(node, endpoint, *watch->second);
  }
  if (is_service(endpoint.kind) && is_for_management(endpoint.name)) return;
  inbox_.put(EndpointAppeared{node, endpoint.kind, endpoint.name});
}

// A node subscribes to /clock while its use_sim_time is set.
void Link::on_subscription(const std::string& node, const std::string& topic) {
  if (topic != SimulatedClock::kTopic || !context_->graph().node(node)) return;
  const auto component = binding_.find(node);
  const bool is_main = component && !other_nodes_->has(*component, node);
  if (ComponentLink* link = is_main ? link_of(*component) : nullptr) link->ask_time_source_again();
}

void Link::tell_writers(const std::string& topic) {
  TopicWatch::Writers writers;
  const ros2::Graph& graph = context_->graph();
  for (const auto& [writer, node] : graph.publishers_of(topic)) {
    const auto component = binding_.bind(node);
    // Anybody can claim to be that node.
    if (component && graph.owner_of(writer).counts) writers[writer] = *component;
  }
  watches_.at(topic)->knows_writers(std::move(writers));
}

void Link::find_type(const std::string& node, const ros2::GraphEndpoint& endpoint,
                     TopicWatch& watch) {
  if (!watch.reads_fields()) return watch.publisher_seen(endpoint.type, endpoint.qos, nullptr);
  types_->find({node, endpoint.type, endpoint.type_hash, context_->graph().process_of(node)},
               [&watch, type = endpoint.type,
                qos = endpoint.qos](const Expected<ros2::MessageLibrary*>& library) {
                 watch.publisher_seen(type, qos, library);
               });
}

rtps::GuidPrefix Link::participant_of(const std::string& node) const {
  return context_->graph().node(node).value_or(ros2::GraphNode{}).participant;
}

void Link::probe() {
  const Time now = live_now();
  starvation_.note(later(probed_last_.value_or(now), kProbePeriod), now);
  probed_last_ = now;
  context_->forget_ended_namesakes();
  context_->look_at_unproven();
  for (const auto& [topic, watch] : watches_) {
    if (watch->waits_for_writers()) tell_writers(topic);
  }
  std::set<ComponentId> are_probed;
  for (const auto& [node, each] : probed_) {
    are_probed.insert(each.component);
    ComponentLink* link = make_link(each.component, node);
    const std::string host = hosts_->host_of(each.component);
    if (host.empty()) {
      link->probe(each.pid);
    } else {
      link->probe(each.pid, [this, host] { return hosts_->heard(host); });
    }
  }
  other_nodes_->probe();
  for (std::size_t c = 0; c < rules_.components.size(); ++c) {
    if (ComponentLink* link = link_of(ComponentId(c))) link->ask_again();
  }
  for (const Parameter& parameter : rules_.parameters) {
    if (ComponentLink* link = link_of(parameter.component)) link->check_parameters();
  }
  for (const Input& input : rules_.inputs) {
    if (input.kind != Input::Kind::kLifecycle || are_probed.contains(input.component)) continue;
    if (ComponentLink* link = link_of(input.component)) link->check_lifecycle();
  }
  for (const Group& group : rules_.groups) {
    for (const ComponentId member : group.members) {
      ComponentLink* link = are_probed.contains(member) ? nullptr : link_of(member);
      if (link != nullptr) link->check_lifecycle();
    }
  }
}

// Reports only a process on this machine that is proven to be the node's.
void Link::tell_usage() {
  constexpr Duration kAtOnce = std::chrono::milliseconds(50);
  for (auto& [component, meter] : meters_) {
    const int pid = context_->graph().process_of(binding_.node_of(component));
    const Time before = live_now();
    const auto usage = pid == 0 ? std::nullopt : usage_of(pid);
    const Time now = live_now();
    if (!usage || now > later(before, kAtOnce)) continue;  // it is not known when it was so
    const auto cores = meter.look(pid, *usage, now);
    if (cores) inbox_.put(UsageSeen{component, *cores, usage->resident_mib});
  }
}

std::vector<ListeningProof::Silent> Link::silent_topics() const {
  std::vector<ListeningProof::Silent> silent;
  for (const auto& [name, watch] : watches_) {
    const ros2::Graph::Publishers& publishers = context_->graph().nodes_publishing(name);
    if (publishers.size() != 1 || watch->has_heard() || !watch->is_listening()) continue;
    const std::string& node = publishers.begin()->first;
    silent.push_back({watch->topic(), node, participant_of(node)});
  }
  return silent;
}

void Link::prove_listening(Time until) {
  if (options_.participant.servers.empty()) listening_->seek(until);
}

// ---- commands

ComponentLink* Link::link_of(ComponentId component) {
  const MutexLock lock(mutex_);
  return links_[component.index].get();
}

ComponentLink* Link::make_link(ComponentId component, const std::string& node) {
  const MutexLock lock(mutex_);
  auto& link = links_[component.index];
  if (!link)
    link = std::make_unique<ComponentLink>(node_->entry(), component, node, rules_, inbox_, *types_,
                                           starvation_);
  return link.get();
}

void Link::execute(const Command& command) {
  const Component& component = rules_[command.component];
  ComponentLink* link = link_of(command.component);
  // Asked for before it was ever seen: a declared node's name is known all the same.
  if (link == nullptr && !component.node.empty())
    link = make_link(command.component, component.node);
  if (link != nullptr) return link->execute(command);
  inbox_.put(Reply{
      command.id, Outcome::kUnreachable, {}, "no node called " + component.name + " was seen"});
}

void Link::publish(std::vector<Health> health) {
  {
    const MutexLock lock(mutex_);
    health_ = std::move(health);
  }
  publish_again();
}

void Link::publish_again() {
  ros2::msg::DiagnosticArray message;
  message.header.stamp = ros2::msg::to_time(std::chrono::system_clock::now());
  {
    const MutexLock lock(mutex_);
    for (const Health& h : health_) {
      ros2::msg::DiagnosticStatus status{h.level, h.name, h.message, kCulpritsHardwareId, {}};
      for (const auto& [key, value] : h.values) status.values.push_back({key, value});
      message.status.push_back(std::move(status));
    }
  }
  for (const auto& [node, text] : contests_.texts()) {
    constexpr std::uint8_t kWarn = 1;
    message.status.push_back({kWarn, "culprit: " + node, text, kCulpritsHardwareId, {}});
  }
  for (const auto& [status, text] : diagnostics_watch_->conflicts()) {
    constexpr std::uint8_t kWarn = 1;
    message.status.push_back(
        {kWarn, "culprit: " + printable(status), text, kCulpritsHardwareId, {}});
  }
  if (!message.status.empty()) diagnostics_->publish(message);
}

void Link::log(ros2::Severity severity, std::string text) { node_->log(severity, std::move(text)); }

}  // namespace culprit::link
