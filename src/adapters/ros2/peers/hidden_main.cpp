// A node in a process of its own, for drills that search for hidden dependencies. It may depend on another node in a way
// that the graph of the robot does not show:
//
//     ros2_peer_hidden <name> [--needs-topic NAME] [--writes-file FILE] [--needs-file FILE] [--sends-to PORT]
//                      [--needs-port PORT] [--serves] [--needs-service NAME]
//
// Node /<name> publishes /<name>/value at 10 Hz. With a need it publishes only while that was fulfilled in the last 150 ms:
// by /NAME/value, by a change of FILE, by a datagram at PORT, by an answer of /NAME/ask. The client of that service belongs
// to another node, /<name>_io, in a participant of its own. Takes a second to start, as drivers do. The environment chooses the
// robot, as for each ROS 2 node.
#include <arpa/inet.h>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <memory>
#include <netinet/in.h>
#include <optional>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

#include "base/live_clock.h"
#include "ros2/messages.h"
#include "ros2/node.h"
#include "ros2/options.h"
#include "ros2/services.h"
#include "ros2/timer.h"

namespace {

using namespace culprit;
using namespace culprit::ros2;
using namespace std::chrono_literals;

constexpr Duration kPeriod = 100ms;
constexpr Duration kFresh = 150ms;
constexpr Duration kStarting = 1s;

struct Wishes {
  std::string name, needs_topic, writes_file, needs_file, needs_service;
  int sends_to = 0;
  int needs_port = 0;
  bool serves = false;

  bool has_need() const {
    return !needs_topic.empty() || !needs_file.empty() || !needs_service.empty() || needs_port != 0;
  }
};

sockaddr_in local(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

class Dependent {
 public:
  explicit Dependent(const Wishes& wishes) : wishes_(wishes) {}
  ~Dependent() {
    if (socket_ >= 0) close(socket_);
  }

  Expected<void> open(Executor& executor, Context& context, Context& hidden) {
    auto node = Node::create(context, {"/", wishes_.name});
    if (!node) return Error{node.error()};
    node_ = std::move(*node);
    auto value = node_->create_publisher<msg::Float64>("~/value");
    if (!value) return Error{value.error()};
    value_.emplace(std::move(*value));
    if (auto opened = open_services(hidden); !opened) return opened;
    if (!wishes_.needs_topic.empty()) {
      auto heard = node_->create_subscription<msg::Float64>(
          "/" + wishes_.needs_topic + "/value", rtps::qos::kDefault,
          [this](const msg::Float64&) { fulfilled_ = live_now(); });
      if (!heard) return Error{heard.error()};
      subscription_ = std::move(*heard);
    }
    if (wishes_.sends_to != 0 || wishes_.needs_port != 0)
      socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    const sockaddr_in own = local(wishes_.needs_port);
    if (wishes_.needs_port != 0 &&
        bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0)
      return Error{"the port is taken"};
    tick_.emplace(executor, kPeriod, [this] { tick(); });
    return {};
  }

 private:
  Expected<void> open_services(Context& hidden) {
    if (wishes_.serves) {
      auto served = node_->create_service<srv::Trigger>("~/ask", [](const srv::Trigger::Request&) {
        return srv::Trigger::Response{true, ""};
      });
      if (!served) return Error{served.error()};
      server_ = std::move(*served);
    }
    if (wishes_.needs_service.empty()) return {};
    auto other = Node::create(hidden, {"/", wishes_.name + "_io"}, Node::Extent::kMinimal);
    if (!other) return Error{other.error()};
    hidden_node_ = std::move(*other);
    auto client = hidden_node_->create_client<srv::Trigger>("/" + wishes_.needs_service + "/ask",
                                                            rtps::qos::kServices);
    if (!client) return Error{client.error()};
    client_ = std::move(*client);
    return {};
  }

  void tick() {
    if (!wishes_.writes_file.empty()) std::ofstream(wishes_.writes_file) << ++ticks_ << '\n';
    if (wishes_.sends_to != 0) {
      const sockaddr_in to = local(wishes_.sends_to);
      (void)sendto(socket_, "x", 1, 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
    }
    look();
    if (!wishes_.has_need() || live_now() - fulfilled_ < kFresh + kPeriod) value_->publish({1});
  }

  void look() {
    char byte = 0;
    while (wishes_.needs_port != 0 && recv(socket_, &byte, 1, 0) == 1) fulfilled_ = live_now();
    if (!wishes_.needs_file.empty()) {
      std::string line;
      std::getline(std::ifstream(wishes_.needs_file) >> std::ws, line);
      if (!line.empty() && line != last_line_) fulfilled_ = live_now();
      if (!line.empty()) last_line_ = line;
    }
    if (client_ == nullptr || is_asking_) return;
    is_asking_ = true;
    client_->call({}, Repeat::kUntilAnswered, 300ms, [this](const auto& answer) {
      is_asking_ = false;
      if (answer.response) fulfilled_ = live_now();
    });
  }

  const Wishes wishes_;
  std::unique_ptr<Node> node_;
  std::unique_ptr<Node> hidden_node_;
  std::optional<Publisher<msg::Float64>> value_;
  std::unique_ptr<Subscription> subscription_;
  std::unique_ptr<ServiceServer> server_;
  std::unique_ptr<Client<srv::Trigger>> client_;
  bool is_asking_ = false;
  int socket_ = -1;
  int ticks_ = 0;
  std::string last_line_;
  Time fulfilled_ = kLongAgo;
  std::optional<Timer> tick_;
};

int fail(const std::string& why) {
  std::fprintf(stderr, "ros2_peer_hidden: %s\n", why.c_str());
  return 1;
}

std::optional<Wishes> wishes_in(int argc, char** argv) {
  if (argc < 2) return std::nullopt;
  Wishes wishes;
  wishes.name = argv[1];
  for (int i = 2; i < argc; ++i) {
    const std::string_view option = argv[i];
    if (option == "--serves") {
      wishes.serves = true;
      continue;
    }
    if (++i == argc) return std::nullopt;
    if (option == "--needs-topic") wishes.needs_topic = argv[i];
    if (option == "--writes-file") wishes.writes_file = argv[i];
    if (option == "--needs-file") wishes.needs_file = argv[i];
    if (option == "--needs-service") wishes.needs_service = argv[i];
    if (option == "--sends-to") wishes.sends_to = std::atoi(argv[i]);
    if (option == "--needs-port") wishes.needs_port = std::atoi(argv[i]);
  }
  return wishes;
}

}  // namespace

int main(int argc, char** argv) {
  const auto wishes = wishes_in(argc, argv);
  if (!wishes) return fail("usage: ros2_peer_hidden <name> [option]...");
  std::this_thread::sleep_for(kStarting);
  Executor executor;
  if (auto stops = executor.stop_on({SIGINT, SIGTERM}); !stops) return fail(stops.error());
  const auto options = options_from_environment();
  if (!options) return fail(options.error());
  auto context = Context::create(executor, *options);
  auto hidden = Context::create(executor, *options);
  if (!context || !hidden) return fail((context ? hidden : context).error());
  Dependent dependent(*wishes);
  if (auto opened = dependent.open(executor, **context, **hidden); !opened)
    return fail(opened.error());
  executor.run();
  return 0;
}
