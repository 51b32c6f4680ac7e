// A managed node in a process of its own, for tests to watch, steer and kill:
//
//     ros2_peer_node <domain> [--hangs-if FILE] <full name>...
//
// If there is FILE when it is activated, it takes the file away and does nothing more.
//
// Each has the parameters gain (0..10), count (not negative), label and serial (read-only), the
// service ~/trigger, ~/value at 10 Hz while it is active, and one status on /diagnostics each
// second. Of several the first is a component container (rclcpp_components), which loads nothing
// more, and the others live in it.
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "ros2/lifecycle_node.h"
#include "ros2/messages.h"
#include "ros2/services.h"
#include "ros2/timer.h"

namespace {

using namespace culprit;
using namespace culprit::ros2;
using namespace std::chrono_literals;

class PeerNode {
 public:
  PeerNode(Executor& executor, std::string hangs_if)
      : executor_(executor), hangs_if_(std::move(hangs_if)) {}

  Expected<void> open(Context& context, NodeName name) {
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

  Expected<void> serve_loading() {
    auto load = ServiceServer::create(managed_->node().entry(),
                                      {managed_->node().name().full() + "/_container/load_node",
                                       "composition_interfaces/srv/LoadNode"},
                                      qos::kServices, [](ByteView) { return Bytes(); });
    if (!load) return Error{load.error()};
    load_ = std::move(*load);
    return {};
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
    return TransitionResult::kSuccess;
  }
  TransitionResult activate() {
    if (std::filesystem::remove(hangs_if_)) std::this_thread::sleep_for(1h);
    tick_.emplace(executor_, 100ms, [this] {
      value_->publish({managed_->node().parameters().get<double>("gain") * ++ticks_});
    });
    return TransitionResult::kSuccess;
  }
  TransitionResult deactivate() {
    tick_.reset();
    return TransitionResult::kSuccess;
  }
  TransitionResult release() {
    tick_.reset();
    value_.reset();
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
  const std::filesystem::path hangs_if_;
  int triggered_ = 0;
  int ticks_ = 0;
  std::unique_ptr<LifecycleNode> managed_;
  std::unique_ptr<ServiceServer> trigger_;
  std::unique_ptr<ServiceServer> load_;
  std::optional<Publisher<msg::DiagnosticArray>> diagnostics_;
  std::optional<Publisher<msg::Float64>> value_;
  std::optional<Timer> diagnose_;
  std::optional<Timer> tick_;
};

int fail(const std::string& why) {
  std::fprintf(stderr, "ros2_peer_node: %s\n", why.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return fail("usage: ros2_peer_node <domain> [--hangs-if FILE] <full name>...");
  Executor executor;
  if (auto stops = executor.stop_on({SIGINT, SIGTERM}); !stops) return fail(stops.error());
  ParticipantOptions options;
  const std::string_view domain = argv[1];
  std::from_chars(domain.data(), domain.data() + domain.size(), options.domain);
  options.reach = Reach::kLocalhost;
  options.gid_size = GidSize::kHumbleAndOlder;
  auto context = Context::create(executor, options);
  if (!context) return fail(context.error());
  std::vector<std::unique_ptr<PeerNode>> peers;
  const bool may_hang = std::string_view(argv[2]) == "--hangs-if" && argc > 4;
  const std::string hangs_if = may_hang ? argv[3] : "";
  for (int i = may_hang ? 4 : 2; i < argc; ++i) {
    auto name = parse_node_name(argv[i]);
    if (!name) return fail(name.error());
    peers.push_back(std::make_unique<PeerNode>(executor, hangs_if));
    if (auto opened = peers.back()->open(**context, *name); !opened) return fail(opened.error());
  }
  if (peers.size() > 1) {
    if (auto opened = peers.front()->serve_loading(); !opened) return fail(opened.error());
  }
  executor.run();
  return 0;
}
