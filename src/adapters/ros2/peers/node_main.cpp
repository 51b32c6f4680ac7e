// A managed node in a process of its own, for tests to watch, steer and kill:
//
//     ros2_peer_node <domain> [--subnet] [--hangs-if FILE] [--container] [--keeps-if FILE]
//                    [--active] [--activates-after SECONDS] [--stalls-if FILE] [--period SECONDS]
//                    <full name>...
//
// It can be discovered on this machine only, unless --subnet.
//
// If there is FILE when it is activated, it takes the file away and does nothing more.
//
// With --active the first configures and activates itself, as many drivers do. With
// --activates-after it does so by a timer. It ends with 1 if somebody was there first, as nodes in
// Python do whose timer raises "Transition is not registered".
//
// If there is the FILE of --stalls-if when it has published, it takes the file away, and its only
// thread hangs for as many seconds as the file says: it publishes nothing, answers nothing, and
// obeys no polite signal.
//
// Each has the parameters gain (0..10), count (not negative), label and serial (read-only), and the
// service ~/trigger. While it is active it publishes ~/value and ~/load, which is of a type of its
// own, at 10 Hz, or each --period, and one status on /diagnostics each second.
//
// If there are several, or with --container, the first is a component container, and the others
// live in it. It loads, unloads and lists as rclcpp_components' ComponentManager does: classes by
// the ament index of its environment, numbers from 1, the same texts. Every class is one of these
// nodes. It prints what it loads and unloads. While there is the FILE of --keeps-if it unloads
// nothing, and answers so.
#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "ros2/lifecycle_node.h"
#include "ros2/messages.h"
#include "ros2/services.h"
#include "ros2/timer.h"

namespace {

using namespace culprit;
using namespace culprit::ros2;
using namespace std::chrono_literals;

// A type that other programs know only if they were told.
struct Load {
  static constexpr std::string_view kType = "peer_msgs/msg/Load";
  double share = 0;
  std::int64_t jobs = 0;
  static void visit(auto& self, auto& each) { each(self.share, self.jobs); }
};

class PeerNode {
 public:
  struct Habits {
    std::string hangs_if{};
    std::string stalls_if{};
    Duration period = 100ms;
  };
  PeerNode(Executor& executor, Habits habits) : executor_(executor), habits_(std::move(habits)) {}

  Expected<void> open(Context& context, NodeName name,
                      const std::vector<msg::Parameter>& overrides = {}) {
    auto managed = LifecycleNode::create(context, std::move(name),
                                         {.on_configure = [this] { return configure(); },
                                          .on_cleanup = [this] { return release(); },
                                          .on_activate = [this] { return activate(); },
                                          .on_deactivate = [this] { return deactivate(); },
                                          .on_shutdown = [this] { return release(); },
                                          .on_error = {}});
    if (!managed) return Error{managed.error()};
    managed_ = std::move(*managed);
    if (auto declared = declare_parameters(); !declared) return declared;
    if (!overrides.empty()) {
      const auto set = managed_->node().parameters().set(overrides);
      if (!set.successful) return Error{set.reason};
    }

    auto trigger = managed_->node().create_service<srv::Trigger>(
        "~/trigger", [this](const srv::Trigger::Request&) {
          return srv::Trigger::Response{true, "triggered " + std::to_string(++triggered_)};
        });
    if (!trigger) return Error{trigger.error()};
    trigger_ = std::move(*trigger);
    auto diagnostics = managed_->node().create_publisher<msg::DiagnosticArray>("/diagnostics");
    if (!diagnostics) return Error{diagnostics.error()};
    diagnostics_.emplace(std::move(*diagnostics));
    diagnose_.emplace(executor_, 1s, [this] { diagnose(); });
    managed_->node().log(Severity::kInfo, "ready");
    return {};
  }

  ros2::Node& node() { return managed_->node(); }

  bool bring_up() {
    return managed_->trigger(TransitionId::kConfigure) &&
           managed_->trigger(TransitionId::kActivate);
  }

 private:
  Expected<void> declare_parameters() {
    ParameterStore& parameters = managed_->node().parameters();
    msg::ParameterDescriptor in_range;
    in_range.floating_point_range = {{0, 10, 0}};
    msg::ParameterDescriptor read_only;
    read_only.read_only = true;
    for (auto& declared :
         {parameters.declare("gain", Value(1.0), in_range), parameters.declare("count", Value(3L)),
          parameters.declare("label", Value("hello")),
          parameters.declare("serial", Value("SN-1"), read_only)}) {
      if (!declared) return declared;
    }
    parameters.on_set([](std::span<const msg::Parameter> changes) -> Expected<void> {
      for (const msg::Parameter& change : changes) {
        if (change.name == "count" && change.value.integer_value < 0)
          return Error{"count must not be negative"};
      }
      return {};
    });
    return {};
  }

  TransitionResult configure() {
    auto value = managed_->node().create_publisher<msg::Float64>("~/value");
    if (!value) return TransitionResult::kError;
    value_.emplace(std::move(*value));
    auto load = managed_->node().create_publisher<Load>("~/load");
    if (!load) return TransitionResult::kError;
    load_.emplace(std::move(*load));
    return TransitionResult::kSuccess;
  }
  TransitionResult activate() {
    if (std::filesystem::remove(habits_.hangs_if)) std::this_thread::sleep_for(1h);
    tick_.emplace(executor_, habits_.period, [this] {
      value_->publish({managed_->node().parameters().get<double>("gain") * ++ticks_});
      load_->publish({0.5, ticks_});
      stall();
    });
    return TransitionResult::kSuccess;
  }
  void stall() const {
    double seconds = 0;
    if (!(std::ifstream(habits_.stalls_if) >> seconds)) return;
    std::filesystem::remove(habits_.stalls_if);
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  }
  TransitionResult deactivate() {
    tick_.reset();
    return TransitionResult::kSuccess;
  }
  TransitionResult release() {
    tick_.reset();
    value_.reset();
    load_.reset();
    return TransitionResult::kSuccess;
  }

  void diagnose() {
    msg::DiagnosticStatus status{.level = 0,
                                 .name = managed_->node().name().name + ": state",
                                 .message = std::string(label_of(managed_->state())),
                                 .hardware_id = "test",
                                 .values = {{"ticks", std::to_string(ticks_)}}};
    diagnostics_->publish(
        {.header = {.stamp = msg::to_time(std::chrono::system_clock::now()), .frame_id = {}},
         .status = {std::move(status)}});
  }

  Executor& executor_;
  const Habits habits_;
  int triggered_ = 0;
  int ticks_ = 0;
  std::unique_ptr<LifecycleNode> managed_;
  std::unique_ptr<ServiceServer> trigger_;
  std::optional<Publisher<msg::DiagnosticArray>> diagnostics_;
  std::optional<Publisher<msg::Float64>> value_;
  std::optional<Publisher<Load>> load_;
  std::optional<Timer> diagnose_;
  std::optional<Timer> tick_;
};

class Container {
 public:
  Container(Executor& executor, Context& context, std::string keeps_if)
      : executor_(executor), context_(context), keeps_if_(std::move(keeps_if)) {}

  Expected<void> open(Node& node) {
    auto load = node.create_service<srv::LoadNode>(
        "~/_container/load_node",
        [this](const srv::LoadNode::Request& request) { return load_node(request); });
    auto unload = node.create_service<srv::UnloadNode>(
        "~/_container/unload_node",
        [this](const srv::UnloadNode::Request& request) { return unload_node(request.unique_id); });
    auto list = node.create_service<srv::ListNodes>(
        "~/_container/list_nodes", [this](const srv::ListNodes::Request&) { return list_nodes(); });
    for (auto* made : {&load, &unload, &list}) {
      if (!*made) return Error{made->error()};
      services_.push_back(std::move(**made));
    }
    return {};
  }

  Expected<std::uint64_t> add(NodeName name, const std::vector<msg::Parameter>& parameters) {
    auto peer = std::make_unique<PeerNode>(executor_, PeerNode::Habits{});
    if (auto opened = peer->open(context_, std::move(name), parameters); !opened)
      return Error{opened.error()};
    loaded_[++last_id_] = std::move(peer);
    return last_id_;
  }

 private:
  // As the ament index has it.
  static Expected<void> find(const std::string& package, const std::string& plugin) {
    const char* prefixes = std::getenv("AMENT_PREFIX_PATH");
    std::istringstream all(prefixes == nullptr ? "" : prefixes);
    for (std::string prefix; std::getline(all, prefix, ':');) {
      std::ifstream index(prefix + "/share/ament_index/resource_index/rclcpp_components/" +
                          package);
      if (!index) continue;
      for (std::string line; std::getline(index, line);) {
        if (line.substr(0, line.find(';')) == plugin) return {};
      }
      return Error{"Failed to find class with the requested plugin name."};
    }
    return Error{"Could not find requested resource in ament index"};
  }

  srv::LoadNode::Response load_node(const srv::LoadNode::Request& request) {
    if (auto found = find(request.package_name, request.plugin_name); !found)
      return {false, found.error(), "", 0};
    NodeName name{request.node_namespace.empty() ? "/" : request.node_namespace,
                  request.node_name.empty() ? "peer" : request.node_name};
    const std::string full = name.full();
    const auto id = add(std::move(name), request.parameters);
    if (!id) return {false, "Component constructor threw an exception: " + id.error(), "", 0};
    std::printf("loaded %s\n", full.c_str());
    std::fflush(stdout);
    return {true, "", full, *id};
  }

  srv::UnloadNode::Response unload_node(std::uint64_t id) {
    const auto found = loaded_.find(id);
    if (found == loaded_.end())
      return {false, "No node found with unique_id: " + std::to_string(id)};
    if (std::filesystem::exists(keeps_if_)) return {false, "Failed to unload"};
    std::printf("unloaded %s\n", found->second->node().name().full().c_str());
    std::fflush(stdout);
    loaded_.erase(found);
    return {true, ""};
  }

  srv::ListNodes::Response list_nodes() const {
    srv::ListNodes::Response all;
    for (const auto& [id, peer] : loaded_) {
      all.full_node_names.push_back(peer->node().name().full());
      all.unique_ids.push_back(id);
    }
    return all;
  }

  Executor& executor_;
  Context& context_;
  const std::filesystem::path keeps_if_;
  std::vector<std::unique_ptr<ServiceServer>> services_;
  std::map<std::uint64_t, std::unique_ptr<PeerNode>> loaded_;
  std::uint64_t last_id_ = 0;
};

Duration seconds_in(const char* text) {
  return std::chrono::milliseconds(std::lround(1000 * std::atof(text)));
}

int fail(const std::string& why) {
  std::fprintf(stderr, "ros2_peer_node: %s\n", why.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return fail("usage: ros2_peer_node <domain> [option]... <full name>...");
  Executor executor;
  if (auto stops = executor.stop_on({SIGINT, SIGTERM}); !stops) return fail(stops.error());
  ParticipantOptions options;
  const std::string_view domain = argv[1];
  std::from_chars(domain.data(), domain.data() + domain.size(), options.domain);
  options.reach = Reach::kLocalhost;
  options.gid_size = GidSize::kHumbleAndOlder;
  PeerNode::Habits habits;
  std::string keeps_if;
  std::optional<Duration> activates_after;
  bool is_container = false;
  bool is_active = false;
  std::vector<NodeName> names;
  for (int i = 2; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--container") {
      is_container = true;
    } else if (argument == "--active") {
      is_active = true;
    } else if (argument == "--subnet") {
      options.reach = Reach::kSubnet;
    } else if (argument == "--hangs-if" && i + 1 < argc) {
      habits.hangs_if = argv[++i];
    } else if (argument == "--keeps-if" && i + 1 < argc) {
      keeps_if = argv[++i];
    } else if (argument == "--stalls-if" && i + 1 < argc) {
      habits.stalls_if = argv[++i];
    } else if (argument == "--activates-after" && i + 1 < argc) {
      activates_after = seconds_in(argv[++i]);
      if (*activates_after <= Duration::zero()) return fail("--activates-after needs seconds");
    } else if (argument == "--period" && i + 1 < argc) {
      habits.period = seconds_in(argv[++i]);
      if (habits.period <= Duration::zero()) return fail("--period needs seconds");
    } else {
      auto name = parse_node_name(argument);
      if (!name) return fail(name.error());
      names.push_back(std::move(*name));
    }
  }
  if (names.empty()) return fail("no name");
  auto context = Context::create(executor, options);
  if (!context) return fail(context.error());
  PeerNode first(executor, habits);
  if (auto opened = first.open(**context, names.front()); !opened) return fail(opened.error());
  if (is_active && !first.bring_up()) return fail("cannot be brought up");
  std::optional<Container> container;
  if (is_container || names.size() > 1) {
    container.emplace(executor, **context, keeps_if);
    if (auto opened = container->open(first.node()); !opened) return fail(opened.error());
    for (std::size_t n = 1; n < names.size(); ++n) {
      if (auto added = container->add(names[n], {}); !added) return fail(added.error());
    }
  }
  std::optional<Timer> activates;
  bool was_too_late = false;
  const auto activate = [&, is_done = false]() mutable {
    if (std::exchange(is_done, true) || first.bring_up()) return;
    was_too_late = true;
    executor.stop();
  };
  if (activates_after) activates.emplace(executor, *activates_after, activate);
  executor.run();
  return was_too_late ? fail("Transition is not registered.") : 0;
}
