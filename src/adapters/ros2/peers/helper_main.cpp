// A helper program (docs/link-protocol.md) on our own DDS: so that tests can reach a robot as over --link ros where no
// ROS 2 is installed.
//
//     ros2_peer_helper <domain> [--version <n>] [--oversized] [--mute] [--counts <file>] [--drops]
//         <socket>
//
// --version: it claims to speak that one. --oversized: after it has joined, it sends a frame that is too long. --mute:
// it sends nothing after it has joined. --counts: it adds a line to the file for each request that it hands on. --drops:
// it withholds every second sample, and reports that as a dropped datagram.
#include <algorithm>
#include <atomic>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <variant>

#include "base/mutex.h"
#include "culprit_link/protocol.h"
#include "ros2/node.h"
#include "ros2/service_server.h"

namespace {

using namespace culprit;
using namespace culprit::ros2;

struct Manners {
  std::uint32_t domain = 0;
  std::uint32_t version = culprit_link::kVersion;
  bool is_oversized = false;
  bool is_mute = false;
  bool drops = false;
  std::string counts;
  int socket = 0;
};

culprit_link::Quality to_quality(const rtps::Qos& qos) {
  culprit_link::Quality quality;
  quality.is_reliable = qos.reliability == rtps::Reliability::kReliable;
  quality.is_transient_local = qos.durability == rtps::Durability::kTransientLocal;
  return quality;
}

rtps::Qos to_qos(const culprit_link::Quality& quality) {
  rtps::Qos qos;
  qos.reliability =
      quality.is_reliable ? rtps::Reliability::kReliable : rtps::Reliability::kBestEffort;
  qos.durability =
      quality.is_transient_local ? rtps::Durability::kTransientLocal : rtps::Durability::kVolatile;
  qos.history = quality.keeps_all ? rtps::History::kKeepAll : rtps::History::kKeepLast;
  qos.depth = quality.depth;
  return qos;
}

culprit_link::GraphSeen::Node node_of(const std::string& full_name) {
  const auto name = parse_node_name(full_name);
  return name ? culprit_link::GraphSeen::Node{name->name_space, name->name}
              : culprit_link::GraphSeen::Node{};
}

class Peer {
 public:
  explicit Peer(const Manners& manners) : manners_(manners), tasks_(executor_) {}
  ~Peer() { tasks_.close(); }

  int run() {
    const auto join = read_join();
    if (!join) return 1;
    if (manners_.version != culprit_link::kVersion) {
      put(culprit_link::Welcome{manners_.version, "", {}});
      return 1;
    }
    ParticipantOptions options;
    options.domain = manners_.domain;
    options.reach = Reach::kLocalhost;
    options.gid_size = GidSize::kHumbleAndOlder;
    Graph::Options graph;
    graph.listener = [this](const GraphChange&) { tell_graph_soon(); };
    context_ = std::move(*Context::create(executor_, options, std::move(graph)));
    node_ =
        std::move(*Node::create(*context_, {join->name_space, join->name}, Node::Extent::kMinimal));
    put(culprit_link::Welcome{culprit_link::kVersion, "rmw_fastrtps_cpp",
                              context_->participant().guid().bytes});
    tell_graph_soon();
    if (manners_.is_oversized) send_all(culprit_link::Bytes{0xff, 0xff, 0xff, 0xff, 9});
    std::thread reading([this] { read_on(); });
    executor_.run();
    reading.join();
    made_.clear();
    node_.reset();
    context_.reset();
    return 0;
  }

 private:
  using Made = std::variant<std::unique_ptr<RawSubscription>, std::unique_ptr<RawPublisher>,
                            std::unique_ptr<ServiceClient>, std::unique_ptr<ServiceServer>>;

  std::optional<culprit_link::Join> read_join() {
    while (true) {
      if (auto frame = reader_.next()) {
        const auto* join = std::get_if<culprit_link::Join>(&*frame);
        return join == nullptr ? std::nullopt : std::optional(*join);
      }
      if (!receive()) return std::nullopt;
    }
  }

  bool receive() {
    std::array<std::uint8_t, 65536> buffer;
    const ssize_t count = recv(manners_.socket, buffer.data(), buffer.size(), 0);
    if (count <= 0) return false;
    reader_.feed({buffer.data(), static_cast<std::size_t>(count)});
    return !reader_.has_failed();
  }

  void read_on() {
    do {
      while (auto frame = reader_.next()) {
        tasks_.post([this, frame = std::move(*frame)]() mutable {
          std::visit([this](auto& each) { carry_out(each); }, frame);
        });
      }
    } while (receive());
    executor_.stop();
  }

  void send_all(const culprit_link::Bytes& bytes) {
    const MutexLock lock(mutex_);
    std::size_t sent = 0;
    while (sent < bytes.size()) {
      const ssize_t count =
          send(manners_.socket, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (count <= 0) return executor_.stop();
      sent += static_cast<std::size_t>(count);
    }
  }

  void put(const culprit_link::Frame& frame) {
    const bool is_welcome = std::holds_alternative<culprit_link::Welcome>(frame);
    if (!manners_.is_mute || is_welcome) send_all(culprit_link::encode(frame));
  }

  void tell_graph_soon() {
    if (std::exchange(is_graph_due_, true)) return;
    tasks_.post([this] {
      is_graph_due_ = false;
      tell_graph();
    });
  }

  void tell_graph() {
    culprit_link::GraphSeen seen;
    for (const Graph::ParticipantView& participant : context_->graph().participants()) {
      for (const std::string& name : participant.nodes) seen.nodes.push_back(node_of(name));
      for (const Graph::OwnedEndpoint& each : participant.endpoints) {
        const GraphEndpoint& endpoint = each.endpoint;
        const bool publishes = endpoint.kind == EndpointKind::kPublisher;
        const auto node = each.node.empty() ? culprit_link::GraphSeen::Node{} : node_of(each.node);
        if (publishes || endpoint.kind == EndpointKind::kSubscriber) {
          seen.endpoints.push_back({publishes, endpoint.name, endpoint.type, endpoint.type_hash,
                                    each.id.bytes, node, to_quality(endpoint.qos)});
        } else if (!each.node.empty()) {
          seen.services.push_back(
              {endpoint.kind == EndpointKind::kServer, endpoint.name, endpoint.type, node});
        }
      }
    }
    put(seen);
  }

  template <class Thing>
  void keep(std::uint32_t id, Expected<Thing> made) {
    if (!made) return put(culprit_link::Refused{id, made.error()});
    made_[id] = std::move(*made);
  }

  void carry_out(const culprit_link::Subscribe& wanted) {
    const auto tell = [this, id = wanted.id, most = wanted.most](const Sample& sample) {
      if (manners_.drops && sample.identity.sequence % 2 == 0)
        return put(culprit_link::Dropped{++dropped_});
      const auto given = sample.payload.first(std::min<std::size_t>(most, sample.payload.size()));
      put(culprit_link::Arrived{id,
                                sample.identity.writer.bytes,
                                sample.identity.sequence,
                                sample.sent.time_since_epoch().count(),
                                sample.received.time_since_epoch().count(),
                                static_cast<std::uint32_t>(sample.size),
                                {given.begin(), given.end()}});
    };
    keep(wanted.id, RawSubscription::create(node_->entry(), wanted.topic, wanted.type,
                                            to_qos(wanted.quality), PayloadUse::kWhole, tell));
  }
  void carry_out(const culprit_link::Advertise& wanted) {
    keep(wanted.id,
         RawPublisher::create(node_->entry(), wanted.topic, wanted.type, to_qos(wanted.quality)));
  }
  void carry_out(const culprit_link::Use& wanted) {
    keep(wanted.id, ServiceClient::create(node_->entry(), {wanted.service, wanted.type},
                                          to_qos(wanted.quality)));
  }
  void carry_out(const culprit_link::Offer& wanted) {
    keep(wanted.id,
         ServiceServer::create_slow(
             node_->entry(), {wanted.service, wanted.type}, to_qos(wanted.quality),
             [this, id = wanted.id](rtps::ByteView request, ServiceServer::Answer answer) {
               asked_[++last_asked_] = std::move(answer);
               put(culprit_link::Asked{id, last_asked_, {request.begin(), request.end()}});
             }));
  }
  void carry_out(const culprit_link::Remove& wanted) { made_.erase(wanted.id); }
  void carry_out(const culprit_link::Publish& wanted) {
    if (auto* publisher = find<RawPublisher>(wanted.id)) publisher->publish(wanted.payload);
  }
  void carry_out(const culprit_link::Request& wanted) {
    constexpr Duration kForLong = std::chrono::minutes(1);
    auto* client = find<ServiceClient>(wanted.id);
    if (client == nullptr) return;
    if (!manners_.counts.empty())
      std::ofstream(manners_.counts, std::ios::app) << wanted.number << '\n';
    client->call(
        wanted.payload, Repeat::kNever, kForLong,
        [this, id = wanted.id, number = wanted.number](const CallResult& result) {
          if (result.outcome == CallOutcome::kAnswered)
            put(culprit_link::Reply{id, number, {result.reply.begin(), result.reply.end()}});
        });
  }
  void carry_out(const culprit_link::Respond& wanted) {
    if (auto answer = asked_.extract(wanted.number)) answer.mapped()(wanted.payload);
  }
  void carry_out(const culprit_link::Echo& wanted) { put(wanted); }
  template <class Other>
  void carry_out(const Other&) {
    executor_.stop();
  }

  template <class Thing>
  Thing* find(std::uint32_t id) {
    const auto found = made_.find(id);
    if (found == made_.end()) return nullptr;
    auto* thing = std::get_if<std::unique_ptr<Thing>>(&found->second);
    return thing == nullptr ? nullptr : thing->get();
  }

  const Manners manners_;
  culprit_link::FrameReader reader_;
  Mutex mutex_;  // of the socket's end
  Executor executor_;
  std::unique_ptr<Context> context_;
  std::unique_ptr<Node> node_;
  std::map<std::uint32_t, Made> made_;
  std::map<std::int64_t, ServiceServer::Answer> asked_;
  std::int64_t last_asked_ = 0;
  std::atomic<std::uint64_t> dropped_ = 0;
  bool is_graph_due_ = false;
  TaskGroup tasks_;
};

std::uint32_t number_in(std::string_view text) {
  std::uint32_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  Manners manners;
  manners.domain = number_in(argv[1]);
  for (int i = 2; i + 1 < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--version") manners.version = number_in(argv[++i]);
    if (argument == "--counts") manners.counts = argv[++i];
    if (argument == "--oversized") manners.is_oversized = true;
    if (argument == "--mute") manners.is_mute = true;
    if (argument == "--drops") manners.drops = true;
  }
  manners.socket = static_cast<int>(number_in(argv[argc - 1]));
  return Peer(manners).run();
}
