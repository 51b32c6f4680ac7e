// culprit's eyes and hands on a robot of any middleware: a node of that robot, which does what culprit says through a
// socket (culprit_link/protocol.h), and tells it what it sees. It knows no rule and decides nothing.
//
// It uses rcl, the C library below rclcpp and rclpy, since that sends and takes serialized messages of any type, and
// has been the same from Humble on. One thread waits for the middleware and does all work; another reads the socket.
// Its only argument is the number of the socket's file descriptor. It ends when culprit closes the socket.
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <sys/mman.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <utility>

#include <rcl/client.h>
#include <rcl/error_handling.h>
#include <rcl/graph.h>
#include <rcl/guard_condition.h>
#include <rcl/init.h>
#include <rcl/node.h>
#include <rcl/publisher.h>
#include <rcl/service.h>
#include <rcl/subscription.h>
#include <rcl/wait.h>
#include <rmw/rmw.h>
#include <rmw/serialized_message.h>

#include "culprit_link/own_drops.h"
#include "culprit_link/protocol.h"
#include "culprit_link/turn.h"
#include "graph_reading.h"
#include "ignore.h"
#include "type_support.h"

namespace culprit_link {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kBetweenGraphs = std::chrono::milliseconds(50);
constexpr auto kGraphAnyway = std::chrono::seconds(2);
constexpr std::size_t kMostAsked =
    1000;  // requests to a service of culprit that wait for its answer
constexpr std::size_t kMostRequests = 1000;  // of culprit to one service, that wait for theirs
constexpr std::size_t kRestOfFrame = 1024;   // an upper limit for what is beside a payload
constexpr std::size_t kMostWriters = 1000;   // of a topic, whose samples are counted
constexpr auto kBetweenLooks = std::chrono::milliseconds(1);  // for dropped datagrams

std::string last_error() {
  const std::string text = rcl_get_error_string().str;
  rcl_reset_error();
  return text;
}

[[noreturn]] void fail(const std::string& why) {
  std::fprintf(stderr, "culprit_link: %s\n", why.c_str());
  std::_Exit(1);
}

// Writes wait while culprit does not read: meanwhile samples are dropped where they always are, in the history of
// their subscription.
class Channel {
 public:
  explicit Channel(int socket) : socket_(socket) {
    constexpr timeval kPatience{10, 0};
    ignore(setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &kPatience, sizeof kPatience));
  }

  // False: it is too large for a frame.
  bool put(const Frame& frame) {
    const Bytes bytes = encode(frame);
    if (bytes.size() > kLargestFrame + kLengthSize) return false;
    out_.insert(out_.end(), bytes.begin(), bytes.end());
    if (out_.size() > kFlushes) flush();
    return true;
  }

  void flush() {
    std::size_t sent = 0;
    while (sent < out_.size()) {
      const ssize_t count = send(socket_, out_.data() + sent, out_.size() - sent, MSG_NOSIGNAL);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) fail("culprit does not read");
      sent += static_cast<std::size_t>(count);
    }
    out_.clear();
  }

 private:
  static constexpr std::size_t kFlushes = std::size_t{1} << 16;

  const int socket_;
  Bytes out_;
};

struct Subscription {
  rcl_subscription_t raw = rcl_get_zero_initialized_subscription();
  std::uint32_t most = kWhole;
  std::map<Gid, std::uint64_t> last;  // number of each writer that counts its samples
};

struct Publisher {
  rcl_publisher_t raw = rcl_get_zero_initialized_publisher();
};

struct Client {
  rcl_client_t raw = rcl_get_zero_initialized_client();
  std::unique_ptr<MessageForm> request;
  std::unique_ptr<MessageForm> response;
  std::map<std::int64_t, std::int64_t> numbers;  // culprit's, by the middleware's
};

struct Service {
  rcl_service_t raw = rcl_get_zero_initialized_service();
  std::unique_ptr<MessageForm> request;
  std::unique_ptr<MessageForm> response;
  std::map<std::int64_t, rmw_request_id_t> asked;
  std::int64_t last = 0;
};

class Helper {
 public:
  explicit Helper(int socket) : socket_(socket), channel_(socket) {}

  void run() {
    begin(read_join());
    reading_ = std::thread([this] { read_on(); });
    while (!is_over_) {
      wait();
      take_frames();
      if (is_over_) break;
      take_all();
      look_at_graph();
      channel_.flush();
    }
    end();
  }

 private:
  Join read_join() {
    while (true) {
      if (auto frame = reader_.next()) {
        const Join* join = std::get_if<Join>(&*frame);
        if (join == nullptr) fail("the first frame is not Join");
        return *join;
      }
      if (!receive()) fail("culprit ended before it joined");
    }
  }

  // False: the stream is over.
  bool receive() {
    std::array<std::uint8_t, 65536> buffer;
    const ssize_t count = recv(socket_, buffer.data(), buffer.size(), 0);
    if (count < 0 && errno == EINTR) return true;
    if (count <= 0) return false;
    reader_.feed({buffer.data(), static_cast<std::size_t>(count)});
    return !reader_.has_failed();
  }

  void begin(const Join& join) {
    if (join.version != kVersion) {  // culprit says so to a person
      channel_.put(Welcome{});
      channel_.flush();
      fail("culprit speaks another version of the protocol");
    }
    rcl_init_options_t options = rcl_get_zero_initialized_init_options();
    context_ = rcl_get_zero_initialized_context();
    if (rcl_init_options_init(&options, allocator_) != RCL_RET_OK ||
        rcl_init(0, nullptr, &options, &context_) != RCL_RET_OK)
      fail("cannot join the robot: " + last_error());
    rcl_node_options_t node_options = rcl_node_get_default_options();
    node_options.enable_rosout = false;
    node_ = rcl_get_zero_initialized_node();
    if (rcl_node_init(&node_, join.name.c_str(), join.name_space.c_str(), &context_,
                      &node_options) != RCL_RET_OK)
      fail("cannot make a node: " + last_error());
    wake_ = rcl_get_zero_initialized_guard_condition();
    if (rcl_guard_condition_init(&wake_, &context_, rcl_guard_condition_get_default_options()) !=
        RCL_RET_OK)
      fail(last_error());
    graph_changed_ = rcl_node_get_graph_guard_condition(&node_);
    waits_ = rcl_get_zero_initialized_wait_set();
    if (rcl_wait_set_init(&waits_, 0, 2, 0, 0, 0, 0, &context_, allocator_) != RCL_RET_OK)
      fail(last_error());
    channel_.put(Welcome{kVersion, rmw_get_implementation_identifier(), own_gid()});
    channel_.flush();
  }

  // It is read from a publisher that lives for a moment.
  Gid own_gid() {
    Gid gid{};
    std::string why;
    const auto* type = message_type("rcl_interfaces/msg/Log", why);
    rcl_publisher_t publisher = rcl_get_zero_initialized_publisher();
    const rcl_publisher_options_t options = rcl_publisher_get_default_options();
    if (type == nullptr ||
        rcl_publisher_init(&publisher, &node_, type, "~/joins", &options) != RCL_RET_OK) {
      rcl_reset_error();
      return gid;
    }
    // As the graph has it: on Cyclone DDS the publisher itself gives another id.
    for (const GraphSeen::Endpoint& each : read_graph(node_).endpoints) {
      if (each.is_publisher && each.topic == rcl_publisher_get_topic_name(&publisher))
        gid = each.gid;
    }
    ignore(rcl_publisher_fini(&publisher, &node_));
    return gid;
  }

  void read_on() {
    do {
      while (auto frame = reader_.next()) {
        const std::lock_guard lock(mutex_);
        frames_.push_back(std::move(*frame));
      }
      ignore(rcl_trigger_guard_condition(&wake_));
    } while (!reader_.has_failed() && receive());
    is_over_ = true;
    ignore(rcl_trigger_guard_condition(&wake_));
  }

  void wait() {
    ignore(rcl_wait_set_clear(&waits_));
    if (rcl_wait_set_resize(&waits_, subscriptions_.size(), 2, 0, clients_.size(), services_.size(),
                            0) != RCL_RET_OK)
      fail(last_error());
    ignore(rcl_wait_set_add_guard_condition(&waits_, &wake_, nullptr));
    ignore(rcl_wait_set_add_guard_condition(&waits_, graph_changed_, &graph_place_));
    for (auto& [id, each] : subscriptions_)
      ignore(rcl_wait_set_add_subscription(&waits_, &each->raw, nullptr));
    for (auto& [id, each] : clients_) ignore(rcl_wait_set_add_client(&waits_, &each->raw, nullptr));
    for (auto& [id, each] : services_)
      ignore(rcl_wait_set_add_service(&waits_, &each->raw, nullptr));
    const auto until = graph_is_due_ ? read_graph_ + kBetweenGraphs : read_graph_ + kGraphAnyway;
    const auto left = std::max(until - Clock::now(), Clock::duration::zero());
    const rcl_ret_t waited =
        rcl_wait(&waits_, std::chrono::duration_cast<std::chrono::nanoseconds>(left).count());
    if (waited != RCL_RET_OK && waited != RCL_RET_TIMEOUT) fail(last_error());
    rcl_reset_error();
    if (waits_.guard_conditions[graph_place_] != nullptr) graph_is_due_ = true;
  }

  void take_frames() {
    std::deque<Frame> frames;
    {
      const std::lock_guard lock(mutex_);
      frames.swap(frames_);
    }
    for (Frame& frame : frames) std::visit([this](auto& each) { carry_out(each); }, frame);
  }

  // ---- what culprit says

  void carry_out(Subscribe& wanted) {
    std::string why;
    const auto* type = message_type(wanted.type, why);
    if (type == nullptr) return refuse(wanted.id, why);
    auto made = std::make_unique<Subscription>();
    made->most = wanted.most;
    rcl_subscription_options_t options = rcl_subscription_get_default_options();
    options.qos = to_profile(wanted.quality);
    if (rcl_subscription_init(&made->raw, &node_, type, wanted.topic.c_str(), &options) !=
        RCL_RET_OK)
      return refuse(wanted.id, last_error());
    subscriptions_[wanted.id] = std::move(made);
  }

  void carry_out(Advertise& wanted) {
    std::string why;
    const auto* type = message_type(wanted.type, why);
    if (type == nullptr) return refuse(wanted.id, why);
    auto made = std::make_unique<Publisher>();
    rcl_publisher_options_t options = rcl_publisher_get_default_options();
    options.qos = to_profile(wanted.quality);
    if (rcl_publisher_init(&made->raw, &node_, type, wanted.topic.c_str(), &options) != RCL_RET_OK)
      return refuse(wanted.id, last_error());
    publishers_[wanted.id] = std::move(made);
  }

  template <class Made>
  bool find_forms(const std::string& type, Made& made, std::string& why) {
    made.request = MessageForm::of(type + "_Request", why);
    if (made.request) made.response = MessageForm::of(type + "_Response", why);
    return made.response != nullptr;
  }

  void carry_out(Use& wanted) {
    std::string why;
    const auto* type = service_type(wanted.type, why);
    auto made = std::make_unique<Client>();
    if (type == nullptr || !find_forms(wanted.type, *made, why)) return refuse(wanted.id, why);
    rcl_client_options_t options = rcl_client_get_default_options();
    options.qos = to_profile(wanted.quality);
    if (rcl_client_init(&made->raw, &node_, type, wanted.service.c_str(), &options) != RCL_RET_OK)
      return refuse(wanted.id, last_error());
    clients_[wanted.id] = std::move(made);
  }

  void carry_out(Offer& wanted) {
    std::string why;
    const auto* type = service_type(wanted.type, why);
    auto made = std::make_unique<Service>();
    if (type == nullptr || !find_forms(wanted.type, *made, why)) return refuse(wanted.id, why);
    rcl_service_options_t options = rcl_service_get_default_options();
    options.qos = to_profile(wanted.quality);
    if (rcl_service_init(&made->raw, &node_, type, wanted.service.c_str(), &options) != RCL_RET_OK)
      return refuse(wanted.id, last_error());
    services_[wanted.id] = std::move(made);
  }

  void carry_out(const Remove& wanted) {
    if (const auto found = subscriptions_.extract(wanted.id))
      ignore(rcl_subscription_fini(&found.mapped()->raw, &node_));
    if (const auto found = publishers_.extract(wanted.id))
      ignore(rcl_publisher_fini(&found.mapped()->raw, &node_));
    if (const auto found = clients_.extract(wanted.id))
      ignore(rcl_client_fini(&found.mapped()->raw, &node_));
    if (const auto found = services_.extract(wanted.id))
      ignore(rcl_service_fini(&found.mapped()->raw, &node_));
    rcl_reset_error();
  }

  void carry_out(Publish& wanted) {
    const auto found = publishers_.find(wanted.id);
    if (found == publishers_.end()) return;
    rcl_serialized_message_t message = rmw_get_zero_initialized_serialized_message();
    message.allocator = allocator_;
    message.buffer = wanted.payload.data();
    message.buffer_length = wanted.payload.size();
    message.buffer_capacity = wanted.payload.size();
    if (rcl_publish_serialized_message(&found->second->raw, &message, nullptr) != RCL_RET_OK)
      rcl_reset_error();
  }

  void carry_out(const Request& wanted) {
    const auto found = clients_.find(wanted.id);
    if (found == clients_.end()) return;
    Client& client = *found->second;
    const auto request = client.request->deserialize(wanted.payload);
    std::int64_t number = 0;
    if (!request || rcl_send_request(&client.raw, request.get(), &number) != RCL_RET_OK)
      return rcl_reset_error();  // culprit waits in vain, and then looks
    if (client.numbers.size() >= kMostRequests) client.numbers.erase(client.numbers.begin());
    client.numbers[number] = wanted.number;
  }

  void carry_out(const Respond& wanted) {
    const auto found = services_.find(wanted.id);
    if (found == services_.end()) return;
    Service& service = *found->second;
    auto asked = service.asked.extract(wanted.number);
    const auto response = service.response->deserialize(wanted.payload);
    if (!asked || !response) return;
    if (rcl_send_response(&service.raw, &asked.mapped(), response.get()) != RCL_RET_OK)
      rcl_reset_error();
  }

  void carry_out(Echo& wanted) { channel_.put(wanted); }

  // Frames of the other direction.
  template <class Other>
  void carry_out(const Other&) {
    fail("culprit sent a frame that only the helper sends");
  }

  void refuse(std::uint32_t id, const std::string& why) { channel_.put(Refused{id, why}); }

  // ---- what the robot says

  void take_all() {
    for (auto& [id, each] : subscriptions_) take_samples(id, *each);
    for (auto& [id, each] : clients_) take_replies(id, *each);
    for (auto& [id, each] : services_) take_requests(id, *each);
  }

  void take_samples(std::uint32_t id, Subscription& from) {
    take_turn([&] {
      rcl_serialized_message_t message = rmw_get_zero_initialized_serialized_message();
      if (rmw_serialized_message_init(&message, 0, &allocator_) != RMW_RET_OK) return false;
      rmw_message_info_t info = rmw_get_zero_initialized_message_info();
      const rcl_ret_t taken = rcl_take_serialized_message(&from.raw, &message, &info, nullptr);
      if (taken == RCL_RET_OK) tell(id, from, message, info);
      ignore(rmw_serialized_message_fini(&message));
      return taken == RCL_RET_OK;
    });
    rcl_reset_error();
  }

  void tell(std::uint32_t id, Subscription& from, const rcl_serialized_message_t& message,
            const rmw_message_info_t& info) {
    Arrived sample;
    sample.id = id;
    std::memcpy(sample.writer.data(), info.publisher_gid.data, sample.writer.size());
    const bool is_counted =
        info.publication_sequence_number != RMW_MESSAGE_INFO_SEQUENCE_NUMBER_UNSUPPORTED;
    if (is_counted) sample.number = static_cast<std::int64_t>(info.publication_sequence_number);
    sample.sent = info.source_timestamp;
    sample.received = info.received_timestamp;
    sample.size = static_cast<std::uint32_t>(message.buffer_length);
    const std::size_t most = std::min<std::size_t>(from.most, message.buffer_length);
    if (most + kRestOfFrame <= kLargestFrame)
      sample.payload.assign(message.buffer, message.buffer + most);
    if (is_counted && follows_missing(from, sample)) tell_of_drops();
    channel_.put(sample);
  }

  static bool follows_missing(Subscription& from, const Arrived& sample) {
    if (from.last.size() >= kMostWriters) from.last.clear();
    const auto number = static_cast<std::uint64_t>(sample.number);
    const auto [last, is_first] = from.last.try_emplace(sample.writer, number);
    const std::uint64_t step = number - std::exchange(last->second, number);
    return !is_first && step > 1;
  }

  // Anybody may send samples with gaps, and each look takes time.
  void tell_of_drops() {
    const auto now = Clock::now();
    if (now < looked_for_drops_ + kBetweenLooks) return;
    looked_for_drops_ = now;
    const std::uint64_t dropped = drops_.look();
    if (dropped != std::exchange(told_of_drops_, dropped)) channel_.put(Dropped{dropped});
  }

  void take_replies(std::uint32_t id, Client& from) {
    take_turn([&] {
      rmw_service_info_t header{};
      const auto response = from.response->make();
      if (!response) return false;
      if (rcl_take_response_with_info(&from.raw, &header, response.get()) != RCL_RET_OK)
        return false;
      const auto number = from.numbers.extract(header.request_id.sequence_number);
      if (number)
        channel_.put(Reply{id, number.mapped(), from.response->serialize(response.get())});
      return true;
    });
    rcl_reset_error();
  }

  void take_requests(std::uint32_t id, Service& from) {
    take_turn([&] {
      rmw_service_info_t header{};
      const auto request = from.request->make();
      if (!request) return false;
      if (rcl_take_request_with_info(&from.raw, &header, request.get()) != RCL_RET_OK) return false;
      if (from.asked.size() >= kMostAsked) from.asked.erase(from.asked.begin());
      from.asked[++from.last] = header.request_id;
      channel_.put(Asked{id, from.last, from.request->serialize(request.get())});
      return true;
    });
    rcl_reset_error();
  }

  void look_at_graph() {
    const auto now = Clock::now();
    const bool is_due =
        graph_is_due_ ? now >= read_graph_ + kBetweenGraphs : now >= read_graph_ + kGraphAnyway;
    if (!is_due) return;
    graph_is_due_ = false;
    tell_of_drops();
    GraphSeen seen = read_graph(node_);
    read_graph_ = Clock::now();
    if (has_told_ && seen == told_) return;
    if (!channel_.put(seen))
      channel_.put(
          Trouble{"the robot's graph is larger than 16 MiB; culprit sees no change of it, "
                  "until it is smaller. Find the participant that announces so much"});
    told_ = std::move(seen);
    has_told_ = true;
  }

  void end() {
    reading_.join();
    for (auto& [id, each] : subscriptions_) ignore(rcl_subscription_fini(&each->raw, &node_));
    for (auto& [id, each] : publishers_) ignore(rcl_publisher_fini(&each->raw, &node_));
    for (auto& [id, each] : clients_) ignore(rcl_client_fini(&each->raw, &node_));
    for (auto& [id, each] : services_) ignore(rcl_service_fini(&each->raw, &node_));
    ignore(rcl_wait_set_fini(&waits_));
    ignore(rcl_guard_condition_fini(&wake_));
    ignore(rcl_node_fini(&node_));
    ignore(rcl_shutdown(&context_));
    ignore(rcl_context_fini(&context_));
    rcl_reset_error();
  }

  const int socket_;
  Channel channel_;
  FrameReader reader_;  // of the reading thread, once there is one
  const rcl_allocator_t allocator_ = rcl_get_default_allocator();
  rcl_context_t context_;
  rcl_node_t node_;
  rcl_guard_condition_t wake_;
  const rcl_guard_condition_t* graph_changed_ = nullptr;
  std::size_t graph_place_ = 0;  // in the wait set
  rcl_wait_set_t waits_;

  std::mutex mutex_;
  std::deque<Frame> frames_;  // with the mutex
  std::atomic<bool> is_over_ = false;
  std::thread reading_;

  std::map<std::uint32_t, std::unique_ptr<Subscription>> subscriptions_;
  std::map<std::uint32_t, std::unique_ptr<Publisher>> publishers_;
  std::map<std::uint32_t, std::unique_ptr<Client>> clients_;
  std::map<std::uint32_t, std::unique_ptr<Service>> services_;

  OwnDrops drops_;
  std::uint64_t told_of_drops_ = 0;
  Clock::time_point looked_for_drops_{};

  Clock::time_point read_graph_{};
  bool graph_is_due_ = true;
  bool has_told_ = false;
  GraphSeen told_;
};

const char* environment(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

// A killed process leaves its ports in shared memory, where publishers write for nobody from then on; and this one has to
// receive right after its killed predecessor. Humble's Fast DDS does not know the variable, and obeys a profile only.
// Its rmw_fastrtps adds shared memory where ROS_LOCALHOST_ONLY is set, so the profile has to say that as well. No other
// distribution gets the profile: one that does not read it would lose ROS_LOCALHOST_ONLY.
void use_no_shared_memory() {
  setenv("FASTDDS_BUILTIN_TRANSPORTS", "UDPv4", 0);
  const std::string rmw = environment("RMW_IMPLEMENTATION");
  const bool is_fast_dds = rmw.empty() || rmw.find("fastrtps") != std::string::npos;
  const bool has_profile = *environment("FASTRTPS_DEFAULT_PROFILES_FILE") != 0 ||
                           *environment("FASTDDS_DEFAULT_PROFILES_FILE") != 0;
  const bool is_humble = std::strcmp(environment("ROS_DISTRO"), "humble") == 0;
  if (!is_fast_dds || has_profile || !is_humble) return;
  const bool is_local = std::strcmp(environment("ROS_LOCALHOST_ONLY"), "1") == 0;
  const std::string only_here =
      is_local ? "<interfaceWhiteList><address>127.0.0.1</address></interfaceWhiteList>" : "";
  const std::string profile =
      R"(<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">)"
      "<transport_descriptors><transport_descriptor><transport_id>udp</transport_id>"
      "<type>UDPv4</type>" +
      only_here +
      "</transport_descriptor></transport_descriptors>"
      R"(<participant profile_name="culprit_link" is_default_profile="true"><rtps>)"
      "<userTransports><transport_id>udp</transport_id></userTransports>"
      "<useBuiltinTransports>false</useBuiltinTransports></rtps></participant></profiles>";
  const int file = memfd_create("culprit_link.xml", MFD_CLOEXEC);
  if (file < 0 || write(file, profile.data(), profile.size()) < 0) return;
  setenv("FASTRTPS_DEFAULT_PROFILES_FILE", ("/proc/self/fd/" + std::to_string(file)).c_str(), 1);
  if (is_local) unsetenv("ROS_LOCALHOST_ONLY");
}

}  // namespace
}  // namespace culprit_link

int main(int argc, char** argv) {
  const int socket = argc == 2 ? std::atoi(argv[1]) : 0;
  if (socket <= 2) {
    std::fprintf(stderr, "culprit_link is started by culprit (culprit run --link ros)\n");
    return 2;
  }
  // Ctrl-C reaches the whole group; culprit ends first, and this program with it.
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGHUP, SIG_IGN);
  culprit_link::use_no_shared_memory();
  culprit_link::Helper(socket).run();
  return 0;
}
