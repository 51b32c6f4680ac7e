#include "link/link.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iterator>
#include <malloc.h>
#include <set>
#include <unistd.h>

#include "base/duration_words.h"
#include "base/environment.h"
#include "base/live_clock.h"
#include "base/tool_names.h"
#include "base/tracer.h"
#include "link/list_parameter.h"
#include "link/named_process.h"
#include "ros2/helper_options.h"
#include "ros2/process_finder.h"
#include "ros2/services.h"
#include "rtps/origins.h"

namespace culprit::ros2 {
namespace {

constexpr Duration kProbePeriod = std::chrono::milliseconds(400);
constexpr Duration kAskPeriod = std::chrono::milliseconds(100);
constexpr Duration kPublishPeriod = std::chrono::seconds(1);
// A node that was announced to leave, and answered.
constexpr auto kLeavingAskedAgain = std::chrono::seconds(2);
constexpr Duration kAskedForParameters = std::chrono::seconds(1);
constexpr Duration kReminder = std::chrono::minutes(1);
// So long after the robot changed, the memory for that is given back.
constexpr auto kGivesBack = std::chrono::seconds(10);
// One that ends, or is ended, needs no person.
constexpr Duration kSettles = std::chrono::seconds(2);

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

std::string read_line(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// "process 99 (ros2 launch robot.launch.py)". A command line is the process's own claim.
std::string process_in_words(int pid) {
  constexpr std::size_t kLongest = 120;
  std::string command = read_line("/proc/" + std::to_string(pid) + "/cmdline");
  while (!command.empty() && command.back() == '\0') command.pop_back();
  std::replace(command.begin(), command.end(), '\0', ' ');
  if (command.size() > kLongest) command = command.substr(0, kLongest) + "...";
  return "process " + std::to_string(pid) +
         (command.empty() ? "" : " (" + printable(command) + ")");
}

// 0: it is gone.
int parent_of(int pid) {
  const std::string stat = read_line("/proc/" + std::to_string(pid) + "/stat");
  const std::size_t end = stat.rfind(')');  // of the name, which may hold anything
  return end + 4 < stat.size() ? std::atoi(stat.c_str() + end + 4) : 0;
}

// The processes that hold nodes of one name, their launchers, and how to end the extra one.
std::string processes_of(const std::vector<GraphNode>& nodes) {
  if (nodes.size() < 2) return "";
  std::string text;
  std::string others;
  for (const GraphNode& node : nodes) {
    text += text.empty() ? "" : "; ";
    if (node.pid == 0) {
      text += node.host.empty() ? "one on another machine" : "one on " + printable(node.host);
      continue;
    }
    const int parent = parent_of(node.pid);
    text += process_in_words(node.pid);
    if (parent == getpid()) {
      text += ", started by this culprit";
    } else {
      if (parent > 1) text += ", started by " + process_in_words(parent);
      others += " " + std::to_string(node.pid);
    }
  }
  text += ". culprit does not act on it until one is left: end the extra one";
  if (!others.empty()) text += " (kill" + others + (others.rfind(' ') > 0 ? ": one of them)" : ")");
  return text + ", and if a launch file starts it again, set respawn to False there";
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
      links_(rules.components.size()) {}

Link::~Link() {
  executor_.stop();
  if (thread_.joinable()) thread_.join();
  // Clients and readers go before the node that they belong to.
  tasks_.close();
  asking_.reset();
  asked_.clear();
  other_nodes_.clear();
  probing_.reset();
  publishing_.reset();
  looking_at_clock_.reset();
  lease_.reset();
  hearing_.reset();
  parameter_events_.reset();
  diagnostics_watch_.reset();
  log_watch_.reset();
  made_clock_ = nullptr;
  clock_.reset();
  watches_.clear();
  links_.clear();
  diagnostics_.reset();
  types_.reset();
  node_.reset();
  context_.reset();
}

Expected<void> Link::start() {
  Graph::Options graph;
  graph.listener = [this](const GraphChange& change) { on_change(change); };
  graph.find_process = [this, finder = ProcessFinder()](const ParticipantInfo& participant) {
    return options_.participant.helper ? find_named(participant) : finder.find(participant);
  };
  graph.is_running = [finder = ProcessFinder()](int pid) { return finder.is_running(pid); };
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
    // One whose process is not proven is doubted when it left (doubt_leaving()).
    if (!component || unproven_.contains(node)) return false;
    const MutexLock lock(mutex_);
    const auto expected = departures_.find(*component);
    return expected == departures_.end() || expected->second < live_now();
  };
  if (options_.participant.helper) {
    auto helper = std::make_shared<HelperOptions>(*options_.participant.helper);
    helper->name_space = options_.name.name_space;
    helper->name = options_.name.name;
    helper->on_trouble = [this](std::string text) { inbox_.put(LinkTrouble{std::move(text)}); };
    options_.participant.helper = std::move(helper);
  }
  auto context = Context::create(executor_, options_.participant, std::move(graph));
  if (!context) return Error{context.error()};
  context_ = std::move(*context);
  context_->participant().on_round([this] { inbox_.hand_over(); });
  auto node = Node::create(*context_, options_.name);
  if (!node) return Error{node.error()};
  node_ = std::move(*node);
  types_ = std::make_unique<TypeFinder>(*node_, options_.types);
  auto publisher = node_->create_publisher<msg::DiagnosticArray>("/diagnostics");
  if (!publisher) return Error{publisher.error()};
  diagnostics_.emplace(std::move(*publisher));
  if (auto declared = declare_parameters(); !declared) return declared;

  for (std::size_t t = 0; t < rules_.topics.size(); ++t) {
    const std::string& name = rules_.topics[t].name;
    if (watches_.contains(name)) continue;
    auto watch = std::make_unique<TopicWatch>(node_->entry(), TopicId(t), rules_, inbox_);
    watch->asks_for_writers([this, name] { tasks_.post([this, name] { tell_writers(name); }); });
    watches_.emplace(name, std::move(watch));
  }
  auto watch =
      DiagnosticsWatch::create(node_->entry(), rules_, inbox_,
                               [this](const std::string& name) { return binding_.bind(name); });
  if (!watch) return Error{watch.error()};
  diagnostics_watch_ = std::move(*watch);
  auto log = LogWatch::create(node_->entry(), rules_, inbox_,
                              [this](const std::string& name) { return binding_.bind(name); });
  if (!log) return Error{log.error()};
  log_watch_ = std::move(*log);
  if (auto watched = watch_parameter_events(); !watched) return watched;
  publishing_ = std::make_unique<Timer>(executor_, kPublishPeriod, [this] {
    publish_again();
    tell_of_refused();
    tell_of_foreign_sources();
    remind();
    listen_to_hosts();
    look_at_hosts();
    tell_usage();
    look_at_clocks();
  });
  for (const Input& input : rules_.inputs) {
    if (input.kind == Input::Kind::kCpu || input.kind == Input::Kind::kMemory)
      meters_.try_emplace(input.component);
  }
  hosts_ = std::make_unique<NeighbourHosts>([this](const GuidPrefix& participant) {
    return context_->participant().heard_last(participant);
  });
  auto hearing = Hearing::begin(context_->participant(), executor_);
  if (!hearing) return Error{hearing.error()};
  hearing_ = std::move(*hearing);
  if (options_.lease) {
    auto lease = LeaseLink::open(*context_, *hearing_, executor_, *options_.lease);
    if (!lease) return Error{lease.error()};
    lease_ = std::move(*lease);
  }
  context_->on_discovery([this](const DiscoveryEvent& event) { on_discovery(event); });
  if (options_.use_sim_time) {
    auto clock = SimulatedClock::open(node_->entry());
    if (!clock) return Error{clock.error()};
    clock_ = std::move(*clock);
    made_clock_ = clock_.get();
  }
  probing_ = std::make_unique<Timer>(executor_, kProbePeriod, [this] { probe(); });
  thread_ = std::thread([this] { executor_.run(); });
  return {};
}

// Within a change of the graph.
FoundProcess Link::find_named(const ParticipantInfo& participant) const {
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
  const Time sure = sure_to_hear(now);
  const SimulatedClock* followed = clock_of_all();
  return followed != nullptr ? std::min(sure, followed->doubtful(now)) : sure;
}

// Null: it is not followed.
const SimulatedClock* Link::clock() const {
  const SimulatedClock* made = made_clock_;
  const bool is_followed = made != nullptr && (options_.use_sim_time || made->has_begun());
  return is_followed ? made : nullptr;
}

// Null: it is followed for none, or for those nodes only that use it.
const SimulatedClock* Link::clock_of_all() const { return is_time_mixed_ ? nullptr : clock(); }

// On the executor's thread, as the next four.
void Link::note_time_source(ComponentId component, const std::string& node, bool is_simulated) {
  if (is_simulated) {
    simulated_.try_emplace(node, Simulated{component});
    return follow_clock(node);
  }
  is_time_mixed_ = true;
  hold_time(node, false);
  simulated_.erase(node);
}

void Link::hold_time(const std::string& node, bool is_held) {
  const auto known = simulated_.find(node);
  if (known == simulated_.end() || known->second.is_held == is_held) return;
  known->second.is_held = is_held;
  inbox_.put(TimeHeld{known->second.component, is_held});
}

// Its publisher does not wait for it.
void Link::look_at_simulated_nodes() {
  for (const auto& [writer, node] : context_->graph().publishers_of(SimulatedClock::kTopic)) {
    if (simulated_.contains(node)) clock_sources_.insert(node);
  }
  if (!clock_sources_.empty()) is_time_mixed_ = true;
  const SimulatedClock* followed = clock();
  if (followed == nullptr || !is_time_mixed_) return;
  const Time now = live_now();
  if (followed->doubtful(now) <= now) clock_stood_ = now;
  const bool is_held = now < later(clock_stood_, SimulatedClock::kAfterJump);
  for (const auto& [node, simulated] : simulated_)
    hold_time(node, is_held && !clock_sources_.contains(node));
  tell_of_pause(is_held, now);
}

// A short pause, as at a jump, is none to speak of.
void Link::tell_of_pause(bool is_held, Time now) {
  constexpr Duration kLong = std::chrono::seconds(2);
  if (!is_held) clock_runs_ = now;
  const bool is_long = is_held && (told_of_pause_ || now > later(clock_runs_, kLong));
  if (std::exchange(told_of_pause_, is_long) == is_long) return;
  inbox_.put(LinkTrouble{is_long
                             ? "the simulated time stands still: culprit judges nothing about its "
                               "nodes until it goes on"
                             : "the simulated time goes on"});
}

void Link::follow_clock(const std::string& node) {
  if (clock_) return;
  auto clock = SimulatedClock::open(node_->entry());
  if (!clock) return inbox_.put(LinkTrouble{clock.error()});
  simulated_node_ = node;
  simulated_since_ = live_now();
  clock_ = std::move(*clock);
  made_clock_ = clock_.get();
  constexpr Duration kLooks = std::chrono::milliseconds(50);
  looking_at_clock_ =
      std::make_unique<Timer>(executor_, kLooks, [this] { look_at_simulated_nodes(); });
}

void Link::look_at_clocks() {
  timespec steady{};
  clock_gettime(CLOCK_BOOTTIME, &steady);
  const Duration running =
      std::chrono::seconds(steady.tv_sec) + std::chrono::nanoseconds(steady.tv_nsec);
  if (const auto step = system_clock_.look(running, Duration(wall_now()))) {
    const bool is_back = *step < Duration::zero();
    inbox_.put(LinkTrouble{"the system clock of this computer was set " +
                           std::string(is_back ? "back" : "ahead") + " by " +
                           in_words(std::chrono::abs(*step)) +
                           (is_back ? ": timers of rclpy, and waits for a time of day, stand "
                                      "still until it has caught up; a restart of their nodes helps"
                                    : ": timers that wait until a time of day fire at once")});
  }
  if (simulated_node_.empty() || told_of_clock_) return;
  constexpr Duration kClockComes = std::chrono::seconds(10);
  if (clock() != nullptr) {
    told_of_clock_ = true;
    inbox_.put(
        LinkTrouble{simulated_node_ +
                    " uses simulated time (use_sim_time): culprit follows /clock, and judges "
                    "nothing about such nodes while that stands still or jumps"});
  } else if (!told_of_no_clock_ && live_now() > later(simulated_since_, kClockComes)) {
    told_of_no_clock_ = true;
    inbox_.put(
        LinkTrouble{simulated_node_ +
                    " uses simulated time (use_sim_time), and no node publishes /clock: its "
                    "timers stand still; start the simulation, or set use_sim_time to false"});
  }
}

bool Link::is_paused() const {
  const Time now = live_now();
  const SimulatedClock* followed = clock_of_all();
  return followed != nullptr && sure_to_hear(now) > now && followed->doubtful(now) <= now;
}

std::string Link::doubt() const {
  if (is_paused()) return clock()->doubt(live_now());
  const Time now = live_now();
  if (lease_ && lease_->sure_until(now) <= now)
    return "culprit was away so long that another one may manage this robot now; it waits for its "
           "messages";
  return options_.participant.helper ? "the helper program of --link ros does not answer"
                                     : hearing_->doubt(now);
}

Expected<void> Link::declare_parameters() {
  for (const auto& [name, value] : options_.parameters) {
    msg::ParameterDescriptor descriptor;
    descriptor.read_only = true;
    if (auto declared = node_->parameters().declare(name, value, descriptor); !declared)
      return declared;
  }
  return {};
}

Expected<void> Link::watch_parameter_events() {
  if (rules_.parameters.empty()) return {};
  // Best effort and deep: many nodes announce at once when a robot starts.
  constexpr Qos kQos{.reliability = Reliability::kBestEffort, .depth = 100};
  auto subscription = RawSubscription::create(
      node_->entry(), "/parameter_events", msg::ParameterEvent::kType, kQos, PayloadUse::kWhole,
      [this](const Sample& sample) {
        constexpr int kMost = 1000;
        auto event = decode<msg::ParameterEvent>(sample.payload);
        if (!event || parameter_events_waiting_ >= kMost) return;
        ++parameter_events_waiting_;
        tasks_.post([this, event = std::move(*event), writer = sample.identity.writer] {
          --parameter_events_waiting_;
          on_parameter_event(event, writer);
        });
      });
  if (!subscription) return Error{subscription.error()};
  parameter_events_ = std::move(*subscription);
  return {};
}

// To discover a robot takes more memory than to know it, and the allocator keeps what is free between what is not. Once for
// all that changes within a while.
void Link::give_memory_back_soon() {
  if (std::exchange(gives_memory_back_, true)) return;
  tasks_.post_at(Executor::Clock::now() + kGivesBack, [this] {
    gives_memory_back_ = false;
    malloc_trim(0);
  });
}

// ---- observations

void Link::on_change(const GraphChange& change) {
  give_memory_back_soon();
  if (const auto* joined = std::get_if<NodeJoined>(&change)) {
    on_joined(joined->node);
  } else if (const auto* left = std::get_if<NodeLeft>(&change)) {
    on_left(left->node, left->was_lost);
  } else if (const auto* endpoint = std::get_if<EndpointJoined>(&change)) {
    on_endpoint(endpoint->node, endpoint->endpoint);
  } else if (const auto* gone = std::get_if<EndpointLeft>(&change)) {
    if (is_service(gone->kind) && is_for_management(gone->name)) return;
    if (const auto known = publishers_.find(gone->name);
        gone->kind == EndpointKind::kPublisher && known != publishers_.end()) {
      const auto one = known->second.find(gone->node);
      if (one != known->second.end()) known->second.erase(one);
    }
    inbox_.put(EndpointVanished{gone->node, gone->kind, gone->name});
  } else if (const auto* namesakes = std::get_if<NodeNamesakes>(&change)) {
    on_namesakes(*namesakes);  // before anybody acts on it
    inbox_.put(NamesakesSeen{namesakes->node, namesakes->others});
  } else if (const auto* doubted = std::get_if<NodeSaidToLeave>(&change)) {
    on_said_to_leave(doubted->node);
  } else if (const auto* trouble = std::get_if<GraphTrouble>(&change)) {
    inbox_.put(LinkTrouble{trouble->text});
  }
}

void Link::on_discovery(const DiscoveryEvent& event) {
  if (const auto* info = std::get_if<ParticipantInfo>(&event)) {
    hosts_->joined(info->guid.prefix(), printable(info->host), is_on_this_machine(*info));
  } else if (const auto* gone = std::get_if<ParticipantGone>(&event)) {
    hosts_->left(gone->guid.prefix(), gone->was_lost, live_now());
  }
  if (lease_) lease_->on_discovery(event);
}

// If culprit was deaf, or stood still, it missed messages meanwhile.
void Link::listen_to_hosts() {
  const Time now = live_now();
  const bool stood_still = later(looked_at_hosts_, 2 * kPublishPeriod) < now;
  if (sure_to_hear(now) <= now || stood_still) hosts_->listens_from(now);
  looked_at_hosts_ = now;
}

// Rules may have nothing to complain of, or complain late: this is reported in its own right.
void Link::on_namesakes(const NodeNamesakes& seen) {
  {
    const MutexLock lock(mutex_);
    std::vector<int>& processes = doubled_[seen.node];
    processes.clear();
    for (const GraphNode& node : seen.all) processes.push_back(node.pid);
    if (seen.others == 0) doubled_.erase(seen.node);
  }
  const bool is_container = std::any_of(
      rules_.components.begin(), rules_.components.end(),
      [&](const Component& c) { return c.composed && c.composed->container == seen.node; });
  if (!is_container && !binding_.bind(seen.node)) return;
  {
    const MutexLock lock(mutex_);
    if (seen.others == 0) {
      contested_.erase(seen.node);
      return;
    }
    contested_[seen.node] = {
        "several nodes have the name " + seen.node + ": " + processes_of(seen.all),
        later(live_now(), kSettles)};
  }
}

std::map<std::string, std::vector<int>> Link::doubled() const {
  const MutexLock lock(mutex_);
  return doubled_;
}

std::map<std::string, std::string> Link::contested() const {
  const MutexLock lock(mutex_);
  std::map<std::string, std::string> all;
  for (const auto& [node, contest] : contested_) all[node] = contest.text;
  return all;
}

std::map<std::string, std::string> Link::nodes_elsewhere() const {
  const MutexLock lock(mutex_);
  return nodes_elsewhere_;
}

std::optional<std::string> Link::cut_off(ComponentId component) {
  look_at_hosts();
  const MutexLock lock(mutex_);
  const auto found = elsewhere_.find(component);
  if (found == elsewhere_.end() || !silent_hosts_.contains(found->second)) return std::nullopt;
  return found->second;
}

// While reception is doubtful, nothing new is known of any.
void Link::look_at_hosts() {
  const Time now = live_now();
  if (sure_to_hear(now) <= now) return;
  std::vector<ComponentId> silent;
  {
    const MutexLock lock(mutex_);
    std::set<std::string> hosts;
    for (const auto& [component, host] : elsewhere_) hosts.insert(host);
    for (const std::string& host : silent_hosts_) hosts.insert(host);
    for (const std::string& host : hosts) {
      const bool is_silent = hosts_->is_silent(host, now);
      const bool is_news =
          is_silent ? silent_hosts_.insert(host).second : silent_hosts_.erase(host) > 0;
      if (is_news) inbox_.put(HostHeard{host, !is_silent});
      for (const auto& [component, where] : elsewhere_) {
        if (is_silent && where == host) silent.push_back(component);
      }
    }
  }
  for (const ComponentId component : silent) {
    if (ComponentLink* link = link_of(component)) link->forget_unanswered();
  }
}

void Link::lives_on(ComponentId component, const std::string& host) {
  {
    const MutexLock lock(mutex_);
    const auto found = elsewhere_.find(component);
    if ((found == elsewhere_.end() ? "" : found->second) == host) return;
    elsewhere_.erase(component);
    if (!host.empty()) elsewhere_[component] = host;
  }
  inbox_.put(LivesOn{component, host});
}

// Only a person can end that, and late joiners must learn of it too.
void Link::remind() {
  const Time now = live_now();
  std::vector<std::string> due;
  {
    const MutexLock lock(mutex_);
    for (auto& [node, contest] : contested_) {
      if (now < contest.due) continue;
      contest.due = later(now, kReminder);
      due.push_back(contest.text);
    }
  }
  for (std::string& text : due) inbox_.put(LinkTrouble{std::move(text)});
  if (auto text = namesake_.due(now)) inbox_.put(LinkTrouble{std::move(*text)});
}

void Link::on_joined(const GraphNode& node) {
  const std::string host = node.pid == 0 ? printable(node.host) : "";
  {
    const MutexLock lock(mutex_);
    nodes_elsewhere_.erase(node.name);
    if (!host.empty()) nodes_elsewhere_.emplace(node.name, host);
  }
  inbox_.put(NodeAppeared{node.name, node.pid});
  pids_[node.name] = node.pid;
  holders_[node.name] = node.participant;
  diagnostics_watch_->node_joined(node.name);
  if (node.name == node_->name().full()) namesake_.joined(node, live_now());
  for (auto& [manager, systems] : systems_) std::erase(systems, node.name);
  leaving_.erase(node.name);
  unproven_.erase(node.name);
  const auto component = binding_.bind(node.name);
  if (!component) return;
  if (node.pid == 0) unproven_[node.name] = {node.vendor, node.participant};
  if (is_other_node(*component, node.name)) return other_node_joined(*component, node);
  make_link(*component, node.name)->lives_in(node.pid, node.participant);
  lives_on(*component, host);
  if (node.pid == 0 || needs_of(*component, rules_).is_to_answer) {
    probed_[node.name] = {*component, node.pid};
  } else {
    probed_.erase(node.name);
  }
}

bool Link::is_other_node(ComponentId component, const std::string& node) const {
  return binding_.has_several(component) && binding_.node_of(component) != node;
}

void Link::other_node_joined(ComponentId component, const GraphNode& node) {
  OtherNode& other = other_nodes_[node.name];
  other.pid = node.pid;
  other.is_there = true;
  if (other.client) return other.client->ask_only(node.participant);
  const auto& all = binding_.other_nodes(component);
  const auto place = std::ranges::find(all, node.name) - all.begin();
  other.component = component;
  other.place = static_cast<std::uint8_t>(std::min<std::ptrdiff_t>(place + 1, 127));
  auto client = ServiceClient::create(
      node_->entry(), {node.name + "/get_parameters", std::string(srv::GetParameters::kType)},
      qos::kParameterServices);
  if (client) {  // a secured domain need not allow it
    (*client)->ask_only(node.participant);
    other.client = std::move(*client);
  }
}

void Link::on_left(const std::string& node, bool was_lost) {
  {
    const MutexLock lock(mutex_);
    nodes_elsewhere_.erase(node);
  }
  if (const auto other = other_nodes_.find(node); other != other_nodes_.end())
    other->second.is_there = false;
  for (auto& [topic, nodes] : publishers_) nodes.erase(node);
  probed_.erase(node);
  pids_.erase(node);
  holders_.erase(node);
  diagnostics_watch_->node_left(node);
  std::erase_if(mode_managers_, [&](const auto& each) { return each.second == node; });
  if (node == node_->name().full()) namesake_.left();
  const auto unproven = unproven_.extract(node);
  if (unproven) return doubt_leaving(node, {unproven.mapped(), was_lost});
  vanished(node, was_lost);
}

// Any program on the network can claim that a node has left whose process is not known. If the node is there, its
// middleware announces it again: Fast DDS after 3 s, Cyclone DDS after 8 s.
void Link::doubt_leaving(const std::string& node, Leaving leaving) {
  constexpr auto kOfFastDds = std::chrono::seconds(4);
  constexpr auto kOfOthers = std::chrono::seconds(9);
  const auto patience = leaving.node.vendor == Vendor::kFastDds ? kOfFastDds : kOfOthers;
  leaving.doubt = ++doubts_;
  leaving_[node] = leaving;
  tasks_.post_at(Executor::Clock::now() + patience,
                 [this, node, doubt = leaving.doubt] { ask_leaving(node, doubt); });
}

// The middleware may know its services still, if a message in its name announced only that it holds
// no node.
void Link::ask_leaving(const std::string& node, std::uint64_t doubt) {
  const auto component = binding_.bind(node);
  const auto found = leaving_.find(node);
  if (!component || found == leaving_.end() || found->second.doubt != doubt) return;
  // Only the node that the component is named after is asked.
  if (is_other_node(*component, node)) return believe_leaving(node, std::nullopt, doubt);
  make_link(*component, node)->ask([this, node, doubt](std::optional<GuidPrefix> answered) {
    tasks_.post([this, node, doubt, answered] { believe_leaving(node, answered, doubt); });
  });
}

void Link::believe_leaving(const std::string& node, std::optional<GuidPrefix> answered,
                           std::uint64_t doubt) {
  const auto found = leaving_.find(node);
  if (found == leaving_.end() || found->second.doubt != doubt) return;
  Leaving leaving = found->second;
  if (answered != leaving.node.participant) {
    leaving_.erase(found);
    return vanished(node, leaving.was_lost);
  }
  if (!std::exchange(leaving.is_told, true))
    inbox_.put(LinkTrouble{node +
                           " was announced to have left, but answers: another program may speak "
                           "in its name. It counts as present"});
  doubt_leaving(node, leaving);
}

void Link::vanished(const std::string& node, bool was_lost) {
  const auto component = was_lost ? std::nullopt : binding_.bind(node);
  if (component && !is_other_node(*component, node)) lives_on(*component, "");
  const auto managed = systems_.extract(node);
  if (managed) {
    for (const std::string& system : managed.mapped()) inbox_.put(NodeVanished{system});
  }
  inbox_.put(NodeVanished{node});
}

// The node announces it, or another program does in its name: the node is asked.
void Link::on_said_to_leave(const std::string& node) {
  if (asked_whether_left_.insert(node).second)
    tasks_.post([this, node] { ask_whether_left(node); });
}

void Link::ask_whether_left(const std::string& node) {
  constexpr int kQuestions = 2;
  if (context_->graph().is_said_to_leave(node)) return ask_whether_left(node, kQuestions);
  asked_whether_left_.erase(node);
}

void Link::ask_whether_left(const std::string& node, int questions) {
  const auto then = [this, node, questions](bool answers) {
    tasks_.post([this, node, questions, answers] { on_whether_left(node, questions, answers); });
  };
  const auto component = binding_.bind(node);
  if (!component) return then(false);
  if (!is_other_node(*component, node)) {
    ComponentLink* link = link_of(*component);
    if (link == nullptr) return then(false);
    return link->ask([then](std::optional<GuidPrefix> answered) { then(answered.has_value()); });
  }
  constexpr Duration kPatience = std::chrono::milliseconds(500);
  const auto other = other_nodes_.find(node);
  if (other == other_nodes_.end() || !other->second.client) return then(false);
  other->second.client->call(
      encode(srv::GetParameters::Request{}), Repeat::kUntilAnswered, kPatience,
      [then](const CallResult& result) { then(result.outcome == CallOutcome::kAnswered); });
}

// One that answers may be leaving all the same, so it is asked again while that is announced.
void Link::on_whether_left(const std::string& node, int questions, bool answers) {
  constexpr std::size_t kMost = 100;
  if (!answers && questions > 1) return ask_whether_left(node, questions - 1);
  if (!answers) {
    asked_whether_left_.erase(node);
    return context_->believe_left(node);
  }
  tasks_.post_at(Executor::Clock::now() + kLeavingAskedAgain,
                 [this, node] { ask_whether_left(node); });
  if (told_of_false_leaving_.size() >= kMost || !told_of_false_leaving_.insert(node).second) return;
  inbox_.put(LinkTrouble{"a message in the name of " + node +
                         " announced that it left the graph, but it answers and counts as "
                         "present. Does another program on this network speak in its name?"});
}

void Link::remember_publishers(const std::map<std::string, std::string>& publishers) {
  for (const auto& [status, node] : publishers) diagnostics_watch_->remember(status, node);
}

void Link::expect_departure(ComponentId component, Time until) {
  const MutexLock lock(mutex_);
  departures_[component] = until;
}

// A system of system_modes is no node: its mode manager offers its services, and it is there as
// long as the manager is. It offers the same for nodes that have modes, which are there by
// themselves.
void Link::on_system(const std::string& manager, const GraphEndpoint& service) {
  const std::string system = service.name.substr(0, service.name.rfind('/'));
  const auto component = binding_.bind(system);
  if (system == manager || !component || rules_[*component].node != system) return;
  if (!may_tell_modes(manager, system)) return;
  if (!pids_.contains(system)) {
    systems_[manager].push_back(system);
    inbox_.put(NodeAppeared{system, pids_[manager]});
  }
  ComponentLink* link = make_link(*component, system);
  link->modes_come_from(holders_[manager]);
  link->service_seen(service);
}

// The first one that offers them, for anybody may; and one that is proven to be here takes the place of one that is not.
bool Link::may_tell_modes(const std::string& manager, const std::string& system) {
  const auto [known, is_new] = mode_managers_.try_emplace(system, manager);
  if (is_new || known->second == manager) return true;
  const bool is_better = pids_[manager] != 0 && pids_[known->second] == 0;
  constexpr std::size_t kMost = 100;
  if (told_of_.size() < kMost && told_of_.emplace(system, manager).second)
    inbox_.put(LinkTrouble{"the modes of " + system + " are offered by " + known->second +
                           " and by " + manager + ": only those of " +
                           (is_better ? manager : known->second) + " count"});
  if (is_better) known->second = manager;
  return is_better;
}

void Link::on_endpoint(const std::string& node, const GraphEndpoint& endpoint) {
  if (endpoint.kind == EndpointKind::kServer) {
    const auto component = binding_.bind(node);
    const bool is_main = component && !is_other_node(*component, node);
    if (is_main && endpoint.name == node + "/change_mode")
      make_link(*component, node)->modes_come_from(holders_[node]);
    if (is_main) make_link(*component, node)->service_seen(endpoint);
    // A secured domain need not allow that question.
    const bool is_to_be_asked = is_main && !options_.use_sim_time &&
                                !options_.participant.security &&
                                endpoint.name == node + "/get_parameters";
    if (is_to_be_asked) {
      make_link(*component, node)->ask_time_source([this, node, component](bool is_simulated) {
        tasks_.post([this, node, component, is_simulated] {
          note_time_source(*component, node, is_simulated);
        });
      });
    }
    if (endpoint.type == srv::ChangeMode::kType) on_system(node, endpoint);
  }
  if (endpoint.kind == EndpointKind::kPublisher) {
    const auto watch = watches_.find(endpoint.name);
    if (watch != watches_.end()) {
      publishers_[endpoint.name].insert(node);
      find_type(node, endpoint, *watch->second);
    }
  }
  if (is_service(endpoint.kind) && is_for_management(endpoint.name)) return;
  inbox_.put(EndpointAppeared{node, endpoint.kind, endpoint.name});
}

void Link::tell_writers(const std::string& topic) {
  TopicWatch::Writers writers;
  const Graph& graph = context_->graph();
  for (const auto& [writer, node] : graph.publishers_of(topic)) {
    const auto component = binding_.bind(node);
    // Anybody can claim to be that node.
    if (component && graph.owner_of(writer).counts) writers[writer] = *component;
  }
  watches_.at(topic)->knows_writers(std::move(writers));
}

void Link::find_type(const std::string& node, const GraphEndpoint& endpoint, TopicWatch& watch) {
  if (!watch.reads_fields()) return watch.publisher_seen(endpoint.type, endpoint.qos, nullptr);
  const auto pid = pids_.find(node);
  types_->find(
      {node, endpoint.type, endpoint.type_hash, pid == pids_.end() ? 0 : pid->second},
      [&watch, type = endpoint.type, qos = endpoint.qos](const Expected<MessageLibrary*>& library) {
        watch.publisher_seen(type, qos, library);
      });
}

// An event from another writer, or from one that is not known as the node's yet, is a reason to
// ask.
void Link::on_parameter_event(const msg::ParameterEvent& event, const Guid& writer) {
  const auto component = binding_.bind(event.node);
  if (!component || is_other_node(*component, event.node)) return;
  const Graph::Owner owner = context_->graph().owner_of(writer);
  if (owner.node != event.node || !owner.counts)
    return ask_for_parameters(*component, event.node, owner.node);
  for (const auto* changes : {&event.new_parameters, &event.changed_parameters}) {
    for (const msg::Parameter& changed : *changes) {
      for (std::size_t p = 0; p < rules_.parameters.size(); ++p) {
        const Parameter& wanted = rules_.parameters[p];
        if (wanted.component != *component || wanted.name != changed.name) continue;
        if (auto value = value_or_list(changed.value))
          inbox_.put(ParameterRead{ParameterId(p), std::move(*value)});
      }
    }
  }
}

void Link::ask_for_parameters(ComponentId component, const std::string& node,
                              const std::string& by) {
  constexpr std::size_t kMost = 100;
  const Time now = live_now();
  Time& asked = parameters_asked_.try_emplace(component, kLongAgo).first->second;
  if (now < later(asked, kAskedForParameters)) return;
  asked = now;
  if (ComponentLink* link = link_of(component)) link->check_values();
  if (by.empty() || told_of_.size() >= kMost || !told_of_.emplace(node, by).second) return;
  inbox_.put(LinkTrouble{printable(by) + " published that parameters of " + node +
                         " changed: what that node answers counts"});
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
    std::string host;
    {
      const MutexLock lock(mutex_);
      const auto found = elsewhere_.find(each.component);
      if (found != elsewhere_.end()) host = found->second;
    }
    if (host.empty()) {
      link->probe(each.pid);
    } else {
      link->probe(each.pid, [this, host] { return hosts_->heard(host); });
    }
  }
  probe_other_nodes();
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
  for (auto& [component, meter] : meters_) {
    const auto pid = pids_.find(binding_.node_of(component));
    const auto usage =
        pid == pids_.end() || pid->second == 0 ? std::nullopt : usage_of(pid->second);
    const auto cores = usage ? meter.look(pid->second, *usage, live_now()) : std::nullopt;
    if (cores) inbox_.put(UsageSeen{component, *cores, usage->resident_mib});
  }
}

void Link::probe_other_nodes() {
  constexpr Duration kPatience = std::chrono::milliseconds(500);
  for (const auto& each : other_nodes_) {
    const OtherNode& other = each.second;
    if (!other.client || !other.is_there) continue;
    other.client->call(encode(srv::GetParameters::Request{}), Repeat::kUntilAnswered, kPatience,
                       [this, component = other.component, place = other.place,
                        pid = other.pid](const CallResult& result) {
                         const bool has_answered = result.outcome == CallOutcome::kAnswered;
                         const bool is_held = !has_answered && pid != 0 && is_traced(pid);
                         if (!is_held) inbox_.put(Probed{component, has_answered, place});
                       });
  }
}

void Link::prove_listening(Time until) {
  if (!options_.participant.servers.empty()) return;
  tasks_.post([this, until] {
    asks_until_ = until;
    asking_ = std::make_unique<Timer>(executor_, kAskPeriod, [this] { ask_silent_ones(); });
  });
}

// Discovery data is ordered for each participant (service_client.h): a node that answers a client
// has discovered each reader that was made before it. So each topic has a client of its own, made
// after its reader.
void Link::ask_silent_ones() {
  const Time now = live_now();
  if (now >= asks_until_) {
    asked_.clear();
    tasks_.post([this] { asking_.reset(); });
    return;
  }
  for (const auto& [name, watch] : watches_) {
    if (watch->has_heard() || !watch->is_listening() || asked_.contains(watch->topic())) continue;
    const auto publishers = publishers_.find(name);
    if (publishers == publishers_.end() || publishers->second.size() != 1) continue;
    const std::string& node = *publishers->second.begin();
    auto client = ServiceClient::create(
        node_->entry(), {node + "/get_parameters", std::string(srv::GetParameters::kType)},
        qos::kParameterServices);
    if (!client) continue;  // a secured domain need not allow it
    if (const auto holder = holders_.find(node); holder != holders_.end())
      (*client)->ask_only(holder->second);
    (*client)->call(encode(srv::GetParameters::Request{}), Repeat::kUntilAnswered,
                    asks_until_ - now, [this, topic = watch->topic()](const CallResult& result) {
                      if (result.outcome == CallOutcome::kAnswered)
                        inbox_.put(ListenerKnown{topic});
                    });
    asked_.emplace(watch->topic(), std::move(*client));
  }
}

// Once for each tenfold: a flood of them is not to be a flood of messages.
void Link::tell_of_refused() {
  const DatagramFilter::Refused refused = context_->participant().refused();
  if (refused.count == 0 || refused.count < 10 * refused_) return;
  refused_ = refused.count;
  inbox_.put(LinkTrouble{std::to_string(refused.count) + " datagrams were kept out so far: " +
                         refused.why + "; which program on this network sends them?"});
}

void Link::tell_of_foreign_sources() {
  Origins& origins = context_->participant().origins();
  origins.check(live_now());
  for (const ForeignSource& source : origins.new_sources()) {
    std::string name = "a node";
    for (const Graph::NodeView& node : context_->graph().bare_nodes()) {
      if (node.participant == source.in_name_of) name = node.node.name;
    }
    const std::string owner =
        source.user ? ", a socket of user " + std::to_string(*source.user) : "";
    const std::string process =
        source.pid == 0 ? "" : " (process " + std::to_string(source.pid) + ")";
    inbox_.put(LinkTrouble{
        "datagrams from " + to_text(source.from) + owner + " speak for " + name + process +
        ", which does not send from there; they are dropped. Find the program that sends them"});
  }
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
  msg::DiagnosticArray message;
  message.header.stamp = msg::to_time(std::chrono::system_clock::now());
  {
    const MutexLock lock(mutex_);
    for (const Health& h : health_) {
      msg::DiagnosticStatus status{h.level, h.name, h.message, kCulpritsHardwareId, {}};
      for (const auto& [key, value] : h.values) status.values.push_back({key, value});
      message.status.push_back(std::move(status));
    }
    for (const auto& [node, contest] : contested_) {
      constexpr std::uint8_t kWarn = 1;
      message.status.push_back({kWarn, "culprit: " + node, contest.text, kCulpritsHardwareId, {}});
    }
  }
  for (const auto& [status, text] : diagnostics_watch_->conflicts()) {
    constexpr std::uint8_t kWarn = 1;
    message.status.push_back(
        {kWarn, "culprit: " + printable(status), text, kCulpritsHardwareId, {}});
  }
  if (!message.status.empty()) diagnostics_->publish(message);
}

void Link::log(Severity severity, std::string text) { node_->log(severity, std::move(text)); }

}  // namespace culprit::ros2
