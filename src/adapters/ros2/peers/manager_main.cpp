// A lifecycle manager in a process of its own, which behaves as Nav2's (nav2_lifecycle_manager of Humble):
//
//     ros2_peer_manager <domain> <full name> <full name of a server>...
//
// - It configures all servers in their order, then activates them. If one refuses, the start has failed,
//   and it does nothing more.
// - A server's ~/value takes the place of its bond: if nothing came for 4 s while all are active, the bond is
//   broken. Then it deactivates the servers backwards and cleans them up backwards. A server that refuses
//   is passed over. One that is missing ends the reset, and nothing is cleaned up.
// - No request has a timeout: a server that is hung, or whose death the middleware has not noticed, blocks
//   it for ever.
// - After a reset it starts all up again if all answer within 10 s.
//
// It prints what it does: "Deactivating /planner". Its node has parameters and answers while it is blocked.
#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "base/live_clock.h"
#include "ros2/lifecycle.h"
#include "ros2/messages.h"
#include "ros2/node.h"
#include "ros2/services.h"

namespace {

using namespace culprit;
using namespace culprit::ros2;
using namespace std::chrono_literals;

constexpr Duration kBondTimeout = 4s;
constexpr Duration kRespawn = 10s;
constexpr Duration kForEver = std::chrono::hours(24);

class Server {
 public:
  Expected<void> open(Node& manager, const std::string& name) {
    name_ = name;
    auto client = ServiceClient::create(
        manager.entry(), {name + "/change_state", std::string(srv::ChangeState::kType)},
        rtps::qos::kServices,
        {{name + "/get_state", std::string(srv::GetState::kType)},
         rtps::encode(srv::GetState::Request{})});
    if (!client) return Error{client.error()};
    change_ = std::move(*client);
    auto bond = manager.create_subscription<msg::Float64>(
        name + "/value", rtps::Qos{.reliability = rtps::Reliability::kBestEffort, .depth = 10},
        [this](const msg::Float64&) { heard_ = live_now(); });
    if (!bond) return Error{bond.error()};
    bond_ = std::move(*bond);
    return {};
  }

  const std::string& name() const { return name_; }
  bool is_there() const { return change_->is_ready(); }
  void begin_bond() { heard_ = live_now(); }
  bool is_bond_broken() const { return later(heard_.load(), kBondTimeout) < live_now(); }

  // Blocks until the server has answered, in whichever way.
  bool change(TransitionId transition) {
    auto answered = std::make_shared<std::promise<bool>>();
    auto answer = answered->get_future();
    srv::ChangeState::Request request;
    request.transition.id = static_cast<std::uint8_t>(transition);
    change_->call(
        rtps::encode(request), Repeat::kNever, kForEver, [answered](const CallResult& result) {
          const auto response = result.outcome == CallOutcome::kAnswered
                                    ? rtps::decode<srv::ChangeState::Response>(result.reply)
                                    : std::nullopt;
          answered->set_value(response && response->success);
        });
    return answer.get();
  }

 private:
  std::string name_;
  std::unique_ptr<ServiceClient> change_;
  std::unique_ptr<Subscription> bond_;
  std::atomic<Time> heard_ = kLongAgo;
};

class LifecycleManager {
 public:
  Expected<void> open(Context& context, NodeName name, const std::vector<std::string>& servers) {
    auto node = Node::create(context, std::move(name));
    if (!node) return Error{node.error()};
    node_ = std::move(*node);
    for (const std::string& each : servers) {
      servers_.push_back(std::make_unique<Server>());
      if (auto opened = servers_.back()->open(*node_, each); !opened) return opened;
    }
    return {};
  }

  // For ever, on a thread of its own.
  void run() {
    while (!are_all_there()) std::this_thread::sleep_for(50ms);
    is_active_ = startup();
    for (;; std::this_thread::sleep_for(200ms)) {
      if (!is_active_ || !is_any_bond_broken()) continue;
      is_active_ = false;
      reset();
      for (const Time end = later(live_now(), kRespawn); !are_all_there() && live_now() < end;)
        std::this_thread::sleep_for(1s);
      if (are_all_there()) is_active_ = startup();
    }
  }

 private:
  bool are_all_there() const {
    return std::ranges::all_of(servers_, [](const auto& each) { return each->is_there(); });
  }
  bool is_any_bond_broken() const {
    return std::ranges::any_of(servers_, [](const auto& each) { return each->is_bond_broken(); });
  }

  bool startup() {
    for (const TransitionId transition : {TransitionId::kConfigure, TransitionId::kActivate}) {
      for (const auto& server : servers_) {
        say(transition == TransitionId::kConfigure ? "Configuring " : "Activating ", *server);
        if (server->change(transition)) continue;
        std::puts("Failed to bring up all requested nodes. Aborting bringup.");
        std::fflush(stdout);
        return false;
      }
    }
    for (const auto& server : servers_) server->begin_bond();
    std::puts("Managed nodes are active");
    std::fflush(stdout);
    return true;
  }

  void reset() {
    for (const TransitionId transition : {TransitionId::kDeactivate, TransitionId::kCleanup}) {
      for (auto server = servers_.rbegin(); server != servers_.rend(); ++server) {
        say(transition == TransitionId::kDeactivate ? "Deactivating " : "Cleaning up ", **server);
        if (!(*server)->is_there()) return;
        (*server)->change(transition);
      }
    }
  }

  static void say(const char* what, const Server& server) {
    std::printf("%s%s\n", what, server.name().c_str());
    std::fflush(stdout);
  }

  std::unique_ptr<Node> node_;
  std::vector<std::unique_ptr<Server>> servers_;
  bool is_active_ = false;
};

int fail(const std::string& why) {
  std::fprintf(stderr, "ros2_peer_manager: %s\n", why.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return fail("usage: ros2_peer_manager <domain> <full name> <server>...");
  Executor executor;
  if (auto stops = executor.stop_on({SIGINT, SIGTERM}); !stops) return fail(stops.error());
  ParticipantOptions options;
  const std::string_view domain = argv[1];
  std::from_chars(domain.data(), domain.data() + domain.size(), options.domain);
  options.reach = Reach::kLocalhost;
  options.gid_size = GidSize::kHumbleAndOlder;
  auto name = parse_node_name(argv[2]);
  if (!name) return fail(name.error());
  auto context = Context::create(executor, options);
  if (!context) return fail(context.error());
  LifecycleManager manager;
  if (auto opened = manager.open(**context, std::move(*name), {argv + 3, argv + argc}); !opened)
    return fail(opened.error());
  std::thread([&manager] { manager.run(); }).detach();
  executor.run();
  std::_Exit(0);  // the thread may be blocked for ever
}
