#include "doctor/look.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "base/live_clock.h"
#include "doctor/asking.h"
#include "doctor/clock_listening.h"
#include "doctor/held_up.h"
#include "doctor/listening.h"
#include "doctor/machine.h"
#include "doctor/never_met.h"
#include "doctor/nodes_to_ask.h"
#include "doctor/process_watch.h"
#include "doctor/transform_listening.h"
#include "doctor/wording.h"
#include "ros2/node.h"
#include "ros2/process_finder.h"
#include "ros2/timer.h"

namespace culprit::doctor {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMostStatuses = 10'000;  // the network decides how many there are
constexpr std::size_t kMostComings = 100;      // of one node
constexpr const char* kDiagnostics = "/diagnostics";

// Used on the executor's thread, which is the caller's, except for message callbacks.
class Look {
 public:
  Look(const LookOptions& options, std::function<void(Picture)> on_picture)
      : options_(options), on_picture_(std::move(on_picture)), tasks_(executor_) {}

  Expected<void> open() {
    ros2::Graph::Options graph;
    graph.listener = [this](const ros2::GraphChange& change) { on_change(change); };
    graph.find_process = [](const ros2::ParticipantInfo& info) {
      return ros2::ProcessFinder().find(info);
    };
    graph.is_running = [](int pid) { return ros2::ProcessFinder().is_running(pid); };
    ros2::ParticipantOptions participant = options_.participant;
    participant.never_meets = never_meets;
    auto context = ros2::Context::create(executor_, participant, std::move(graph));
    if (!context) return Error{context.error()};
    context_ = std::move(*context);
    auto node =
        ros2::Node::create(*context_, {"/", "_culprit_doctor"}, ros2::Node::Extent::kMinimal);
    if (!node) return Error{node.error()};
    node_ = std::move(*node);
    node_name_ = node_->name().full();
    asking_.emplace(*node_);
    transforms_.emplace(node_->entry());
    clock_.emplace(node_->entry());
    topics_.emplace(node_->entry(), [this] { return clock_->now(); });
    return listen_to_diagnostics();
  }

  ~Look() {
    if (context_) context_->participant().leave();
    tasks_.close();
    timer_.reset();
    diagnostics_.reset();
    topics_.reset();
    clock_.reset();
    transforms_.reset();
    asking_.reset();
    node_.reset();
    context_.reset();
  }

  void run(const std::stop_token& stop) {
    const std::stop_callback end(stop, [this] { executor_.stop(); });
    timer_.emplace(executor_, std::clamp<Duration>(options_.time / 16, 100ms, 500ms),
                   [this] { on_tick(); });
    begin();
    executor_.run();
  }
  void stop() { executor_.stop(); }

 private:
  Expected<void> listen_to_diagnostics() {
    constexpr rtps::Qos kQos{.reliability = rtps::Reliability::kBestEffort, .depth = 100};
    auto diagnostics = node_->create_subscription<ros2::msg::DiagnosticArray>(
        kDiagnostics, kQos,
        [this](const ros2::msg::DiagnosticArray& message) { on_diagnostics(message); });
    if (!diagnostics) return Error{diagnostics.error()};
    diagnostics_ = std::move(*diagnostics);
    return {};
  }

  // ---- one look

  void begin() {
    began_ = live_now();
    waits_ = waits_of_own_threads();
    const auto at = [&](Duration after) { return ros2::Executor::Clock::now() + after; };
    // By then who is there was discovered.
    tasks_.post_at(at(options_.time / 3), [this] { ask_all(options_.time / 2); });
    tasks_.post_at(at(options_.time * 5 / 6), [this] { ask_for_states(options_.time / 6); });
    tasks_.post_at(at(options_.time), [this] {
      // Their leases may run for 20 s after they were killed.
      context_->forget_ended_namesakes();
      tasks_.post([this] { end(); });
    });
  }

  void end() {
    listen();
    sample();
    on_picture_(picture());
    const Time now = live_now();
    asking_->begin_anew([this](const std::string& node) { return nodes_.contains(node); });
    topics_->begin_anew(now);
    transforms_->begin_anew(now);
    clock_->begin_anew();
    processes_.begin_anew();
    disks_.clear();
    wiring_changed_ = true;
    ++round_;
    for (auto& [name, status] : statuses_) status.report = {};
    begin();
  }

  void on_tick() {
    listen();
    topics_->take_turns(live_now(), options_.time - since_begin());
    sample();
    if (disks_.empty()) disks_ = disks_of(nodes_);
  }

  void sample() {
    for (const int pid : processes_.sample(nodes_, since_begin()))
      ended_.try_emplace(pid, live_now());
  }

  Duration since_begin() const { return live_now() - began_; }

  // ---- what is listened to

  void listen() {
    if (!std::exchange(wiring_changed_, false)) return;
    const Time now = live_now();
    Picture wiring;
    wiring.nodes = nodes_with_endpoints(context_->graph().participants());
    topics_->listen_to(wanted_topics(wiring, options_.extent));
    const auto& published = context_->graph().published();
    for (const char* topic : {"/tf", "/tf_static"}) {
      if (published.contains(topic)) transforms_->listen_to(topic, now);
    }
    if (published.contains("/clock")) clock_->listen();
  }

  // ---- questions

  bool serves(const ros2::Graph::NodeView& view, const std::string& service) const {
    return std::ranges::any_of(view.endpoints, [&](const ros2::GraphEndpoint& each) {
      return each.kind == EndpointKind::kServer && each.name == view.node.name + service;
    });
  }

  void ask_all(Duration patience) {
    std::vector<ros2::Graph::NodeView> views = context_->graph().nodes();
    std::erase_if(views, [&](const auto& view) { return view.node.name == node_name_; });
    const std::size_t all = views.size();
    const auto chosen = nodes_to_ask(std::move(views), round_);
    unasked_ = all - chosen.size();
    asked_ = chosen.size();
    for (const ros2::Graph::NodeView& view : chosen) {
      const std::string& node = view.node.name;
      if (serves(view, "/get_parameters")) asking_->ask_whether_it_answers(view.node, patience);
      if (serves(view, "/get_state")) asking_->ask_for_state(node, live_now(), patience);
      if (serves(view, "/list_parameters")) ask_for_parameters(view.node, patience / 2);
    }
  }

  // Those that it was started with, unless all are wanted.
  void ask_for_parameters(const ros2::GraphNode& node, Duration patience) {
    if (options_.extent == Extent::kEverything)
      return asking_->ask_for_parameters(node.name, {}, patience);
    const auto process = processes_.processes().find(node.pid);
    if (process == processes_.processes().end()) return;
    const auto given = process->second.parameters.find(node.name);
    if (given == process->second.parameters.end()) return;
    std::vector<std::string> names;
    for (const auto& [name, value] : given->second) names.push_back(name);
    asking_->ask_for_parameters(node.name, names, patience);
  }

  void ask_for_states(Duration patience) {
    for (const auto& [node, state] : asking_->lifecycles())
      asking_->ask_for_state(node, live_now(), patience);
  }

  // ---- observations

  void on_change(const ros2::GraphChange& change) {
    if (const auto* namesakes = std::get_if<ros2::NodeNamesakes>(&change)) {
      if (namesakes->others == 0) {
        namesakes_.erase(namesakes->node);
      } else {
        namesakes_[namesakes->node] = namesakes->all;
      }
    } else if (const auto* joined = std::get_if<ros2::NodeJoined>(&change)) {
      nodes_[joined->node.name] = joined->node.pid;
      on_joined(joined->node);
    } else if (const auto* left = std::get_if<ros2::NodeLeft>(&change)) {
      // The graph shows one of two nodes with one name, and now the other one.
      if (!namesakes_.contains(left->node)) on_left(*left);
      nodes_.erase(left->node);
    } else if (const auto* endpoint = std::get_if<ros2::EndpointJoined>(&change)) {
      wiring_changed_ = wiring_changed_ || endpoint->node != node_name_;
    }
  }

  void on_joined(const ros2::GraphNode& node) {
    const auto comings = comings_.find(node.name);
    if (comings == comings_.end() || comings->second.back().what.is_there) return;
    add(node.name, {.is_there = true, .pid = node.pid});
  }
  void on_left(const ros2::NodeLeft& left) {
    add(left.node, {.is_there = false, .was_lost = left.was_lost});
  }
  void add(const std::string& node, Coming coming) {
    std::vector<Dated>& all = comings_[node];
    if (all.size() < kMostComings) all.push_back({live_now(), coming});
  }

  void on_diagnostics(const ros2::msg::DiagnosticArray& message) {
    const Time now = live_now();
    for (const ros2::msg::DiagnosticStatus& report : message.status) {
      if (statuses_.size() >= kMostStatuses && !statuses_.contains(report.name)) continue;
      HeardStatus& status = statuses_[report.name];
      if (status.count == 0) status.first = now;
      if (status.last != now) ++status.count;  // several of one name in a message are one report
      status.last = now;
      status.report = report;
    }
  }

  // ---- what was seen

  std::vector<Node> nodes_with_endpoints(
      std::vector<ros2::Graph::ParticipantView> participants) const {
    std::vector<Node> nodes;
    std::map<std::pair<rtps::GuidPrefix, std::string>, std::size_t> places;
    for (ros2::Graph::NodeView& view : context_->graph().bare_nodes()) {
      places[{view.participant, view.node.name}] = nodes.size();
      nodes.push_back(Node{std::move(view.node)});
    }
    for (ros2::Graph::ParticipantView& each : participants) {
      for (ros2::Graph::OwnedEndpoint& owned : each.endpoints) {
        const auto place = places.find({each.info.guid.prefix(), owned.node});
        if (place != places.end())
          nodes[place->second].endpoints.push_back(std::move(owned.endpoint));
      }
    }
    return nodes;
  }

  Picture picture() {
    const Time now = live_now();
    auto participants = context_->graph().participants();
    Picture seen;
    seen.domain = options_.participant.domain;
    seen.looked = now - began_;
    seen.waited = longest_wait(waits_, waits_of_own_threads());
    seen.namesakes = namesakes_;
    for (const auto& each : participants) seen.participants.push_back(described(each));
    add_transforms(seen, participants, now);
    seen.nodes = nodes_with_endpoints(std::move(participants));
    seen.unanswered = asking_->unanswered();
    seen.asked = asked_;
    add_ended(seen, now);
    seen.lifecycles = asking_->lifecycles();
    seen.uses_simulated_time = asking_->uses_simulated_time();
    seen.parameters = asking_->parameters();
    add_comings(seen, now);
    for (const auto& [name, status] : statuses_)
      seen.statuses[name] = {status.report, status.count, status.first - began_,
                             status.last - began_};
    seen.flows = topics_->flows(now);
    seen.clock = clock_->seen();
    seen.processes = processes_.processes();
    seen.free_memory = free_memory();
    add_disks(seen);
    seen.other_domains = other_domains(seen.domain, nodes_);
    add_left_out(seen);
    return seen;
  }

  static Participant described(const ros2::Graph::ParticipantView& view) {
    Participant out;
    out.nodes = view.nodes;
    out.vendor = view.info.vendor;
    out.host = view.info.host;
    out.pid = view.pid;
    out.is_secured = view.info.is_secured;
    const auto& addresses = view.info.metatraffic;
    out.is_local = !addresses.empty() && std::ranges::all_of(addresses, [](const auto& address) {
      return address.ip[0] == 127;
    });
    out.form = view.form;
    out.undiscovered = view.undiscovered;
    out.shares_memory = view.info.shares_memory;
    for (std::size_t i = 0; i < 4; ++i)
      out.host_number = out.host_number << 8 | view.info.guid.bytes[i];
    return out;
  }

  // In the graph until its lease ends, if it said no good-bye, for which it has a moment.
  void add_ended(Picture& seen, Time now) const {
    constexpr Duration kGoodBye = 300ms;
    for (const auto& [node, pid] : nodes_) {
      const auto ended = ended_.find(pid);
      if (ended != ended_.end() && now - ended->second >= kGoodBye)
        seen.unanswered[node] = {0, true};
    }
  }

  void add_comings(Picture& seen, Time now) {
    constexpr Duration kRemembered = 10min;
    for (auto& [node, all] : comings_) {
      std::erase_if(all, [&](const Dated& each) { return now - each.at > kRemembered; });
      for (const Dated& each : all) {
        seen.comings[node].push_back(each.what);
        seen.comings[node].back().at = each.at - began_;
      }
    }
    std::erase_if(comings_, [](const auto& entry) { return entry.second.empty(); });
  }

  void add_transforms(Picture& seen, const std::vector<ros2::Graph::ParticipantView>& participants,
                      Time now) {
    std::map<rtps::Guid, std::string> writers;
    for (const auto& each : participants) {
      for (const auto& owned : each.endpoints) writers[owned.id] = owned.node;
    }
    std::map<rtps::Guid, std::size_t> numbers;
    for (auto& [writer, edge] : transforms_->heard(began_)) {
      const auto owner = writers.find(writer);
      if (owner == writers.end()) continue;  // it has left
      edge.node = owner->second;
      edge.writer = std::to_string(numbers.try_emplace(writer, numbers.size()).first->second);
      seen.transforms.push_back(std::move(edge));
    }
    seen.transforms_listened = transforms_->listened(now);
  }

  void add_left_out(Picture& seen) const {
    if (topics_->waiting() > 0)
      seen.left_out.push_back(
          count_of(topics_->waiting(), "topic") +
          " had no turn to be listened to; a longer look (--for) listens to more");
    if (unasked_ > 0)
      seen.left_out.push_back(
          count_of(unasked_, "node") +
          " were not asked anything, only others of their processes; --watch asks "
          "others each time");
  }

  void add_disks(Picture& seen) const {
    for (const Disk& now : disks_of(nodes_)) {
      seen.disks.push_back(now);
      for (const Disk& before : disks_) {
        if (before.folder == now.folder)
          seen.disks.back().taken = std::max<std::int64_t>(0, before.free - now.free);
      }
    }
  }

  struct Dated {
    Time at{};
    Coming what{};
  };
  struct HeardStatus {
    ros2::msg::DiagnosticStatus report{};
    std::size_t count = 0;
    Time first{}, last{};
  };

  const LookOptions options_;
  const std::function<void(Picture)> on_picture_;
  Time began_{};
  std::map<int, Duration> waits_;     // of our threads, when the look began
  std::map<std::string, int> nodes_;  // with their processes; 0: not known
  std::map<std::string, std::vector<ros2::GraphNode>> namesakes_;
  std::map<std::string, std::vector<Dated>> comings_;
  std::map<std::string, HeardStatus> statuses_;
  std::map<int, Time> ended_;
  std::string node_name_;  // ours
  bool wiring_changed_ = false;
  std::size_t round_ = 0;  // of looks
  std::size_t asked_ = 0;  // nodes
  std::size_t unasked_ = 0;
  ProcessWatch processes_;
  std::vector<Disk> disks_;  // when it began

  ros2::Executor executor_;
  ros2::TaskGroup tasks_;
  std::unique_ptr<ros2::Context> context_;
  std::unique_ptr<ros2::Node> node_;
  std::optional<Asking> asking_;
  std::optional<TransformListening> transforms_;
  std::optional<ClockListening> clock_;
  std::optional<Listening> topics_;
  std::unique_ptr<ros2::Subscription> diagnostics_;
  std::optional<ros2::Timer> timer_;
};

}  // namespace

Expected<Picture> look(const LookOptions& options, const std::stop_token& stop) {
  std::optional<Picture> taken;
  Look* running = nullptr;
  Look look(options, [&](Picture picture) {
    taken = std::move(picture);
    running->stop();
  });
  running = &look;
  if (const auto opened = look.open(); !opened) return Error{opened.error()};
  look.run(stop);
  if (!taken) return Error{"the look was stopped before its end"};
  return std::move(*taken);
}

Expected<void> watch(const LookOptions& options, std::function<void(const Picture&)> on_picture,
                     const std::stop_token& stop) {
  Look look(options, std::move(on_picture));
  if (const auto opened = look.open(); !opened) return Error{opened.error()};
  look.run(stop);
  return {};
}

}  // namespace culprit::doctor
