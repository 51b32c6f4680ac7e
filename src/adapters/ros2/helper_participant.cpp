#include "ros2/helper_participant.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <map>
#include <optional>
#include <poll.h>
#include <random>
#include <set>
#include <sys/socket.h>
#include <thread>
#include <utility>
#include <variant>

#include "base/live_clock.h"
#include "base/mutex.h"
#include "base/wake_file.h"
#include "culprit_link/protocol.h"
#include "ros2/helper_endpoint.h"
#include "ros2/helper_endpoints.h"
#include "ros2/helper_graph.h"
#include "ros2/helper_process.h"
#include "ros2/names.h"
#include "ros2/seldom_times.h"
#include "rtps/origins.h"

namespace culprit::ros2 {
namespace {

constexpr Duration kFirstJoin = std::chrono::seconds(20);
constexpr Duration kSettles = std::chrono::seconds(5);
constexpr Duration kSoonest = std::chrono::milliseconds(200);
constexpr Duration kLatest = std::chrono::seconds(10);
constexpr Duration kFlows = std::chrono::seconds(2);      // a topic with a sample in this time
constexpr Duration kNamesCome = std::chrono::seconds(3);  // after a participant's first endpoint
constexpr Duration kAsks = std::chrono::seconds(1);       // whether it is at work
constexpr Duration kHangs = std::chrono::seconds(5);      // one that sends nothing for so long
constexpr auto kLooks = std::chrono::milliseconds(100);
using Ours = HelperEndpoint;  // one of our readers or writers
using Purpose = HelperEndpoint::Purpose;

rtps::SystemTime to_system_time(std::int64_t nanoseconds) {
  return rtps::SystemTime(std::chrono::nanoseconds(nanoseconds));
}

rtps::GuidPrefix random_prefix() {
  rtps::GuidPrefix prefix;
  std::random_device random;
  for (std::uint8_t& byte : prefix.bytes) byte = static_cast<std::uint8_t>(random());
  return prefix;
}

class Helped final : public Participant::Impl {
 public:
  Helped(HelperOptions options, DiscoveryCallback on_discovery)
      : options_(std::move(options)),
        on_discovery_(std::move(on_discovery)),
        ours_(random_prefix()),
        guid_(ours_.guid(1, 0xc1)) {}

  ~Helped() override {
    ends_ = true;
    wake_.wake();
    if (thread_.joinable()) thread_.join();
  }

  Expected<void> open() {
    thread_ = std::thread([this] { run(); });
    MutexLock lock(mutex_);
    const bool is_known = changed_.wait_for(
        lock, kFirstJoin, [this]() CULPRIT_REQUIRES(mutex_) { return has_joined_ || failure_; });
    if (!is_known)
      return Error{"the helper program " + options_.command.front() + " did not join the robot"};
    if (failure_) return Error{*failure_};
    return {};
  }

  const rtps::Guid& guid() const override { return guid_; }
  void leave() override {}
  void hold() override {}
  void release() override {}
  void begin_hurry() override {}
  void end_hurry() override {}
  void on_round(std::function<void()> on_round) override {
    const MutexLock lock(mutex_);
    on_round_ = std::move(on_round);
  }

  // The middleware shows nothing of datagrams.
  rtps::DatagramSources::Origin origin_of(const rtps::GuidPrefix&) const override { return {}; }
  void prove(const rtps::GuidPrefix&, int) override {}
  rtps::Origins& origins() override { return origins_; }
  Time heard_last(const rtps::GuidPrefix&) const override { return live_now(); }
  Time own_came_through() const override { return kNever; }
  void look_at_receivers(Time) override {}
  Time receivers_attended() const override { return kNever; }
  rtps::DatagramFilter::Refused refused() const override { return {}; }
  std::uint64_t dropped_here() const override { return dropped_; }

  Expected<std::unique_ptr<Reader>> create_reader(ReaderOptions options,
                                                  SampleCallback on_sample) override;
  Expected<std::unique_ptr<Writer>> create_writer(WriterOptions options) override;

  // Readers and writers call these.
  void remove(const Ours& ours) {
    ours_.remove(ours);
    wake_.wake();
  }
  std::optional<std::int64_t> write(const Ours& ours, rtps::ByteView payload,
                                    const rtps::SampleIdentity& related) {
    const auto number = ours_.write(ours, payload, related);
    if (number) wake_.wake();
    return number;
  }

 private:
  using OursPtr = HelperEndpoints::Ptr;

  void added(const Ours& ours) {
    if (ours.reads() && ours.meaning.purpose == Purpose::kInfos) infos_are_due_ = true;
    rematches_ = true;
    wake_.wake();
  }

  // ---- the thread that talks to the helper

  void run() {
    Duration pause = kSoonest;
    while (!ends_) {
      auto process = HelperProcess::start(options_);
      std::string why = process ? "" : process.error();
      if (process) why = talk(**process);
      if (is_settled_) pause = kSoonest;  // it worked: the next one is not likely to fail, either
      is_joined_ = false;
      lose_all();
      if (ends_) return;
      fail_first(why);
      if (is_final_) return trouble(why);
      trouble("the helper program of --link ros ended (" + why +
              "): culprit is deaf until it is back");
      sleep(pause);
      pause = std::min(2 * pause, kLatest);
    }
  }

  // Until it ends. Gives why.
  std::string talk(HelperProcess& process) {
    reader_ = culprit_link::FrameReader();
    dropped_by_helper_ = 0;
    ours_.greet(culprit_link::Join{culprit_link::kVersion, options_.name_space, options_.name});
    const Time began = live_now();
    came_last_ = began;
    while (!ends_) {
      std::array<pollfd, 2> files{};
      files[0] = {process.socket(),
                  static_cast<short>(POLLIN | (ours_.has_waiting() ? POLLOUT : 0)), 0};
      files[1] = {wake_.descriptor(), POLLIN, 0};
      constexpr int kLookMs = std::chrono::milliseconds(kLooks).count();
      (void)poll(files.data(), files.size(), kLookMs);
      wake_.clear();
      if (const auto why = receive(process); !why.empty()) return why;
      if (is_joined_ && last_graph_ && rematches_.exchange(false)) match();
      if (is_joined_) deliver_infos();
      if (!ours_.send(process.socket())) return process.end();
      const Time now = live_now();
      if (is_joined_) look_whether_settled(now);
      if (is_joined_ && now > later(asked_last_, kAsks)) {
        ask_whether_it_works(now);
        if (is_settled_ && replaced_.may_come(now) && lacks_announcement(now)) {
          replaced_.came(now);
          process.end();
          return "its middleware has lost the announcement of a participant's nodes";
        }
      }
      if (is_joined_ ? now > later(came_last_, kHangs) : now > later(began, kFirstJoin)) {
        process.end();
        return is_joined_ ? "it hung" : "it did not join the robot";
      }
      if (ours_.is_stuck()) {
        process.end();
        return "it does not read";
      }
    }
    return "";
  }

  // Fast DDS loses one now and then, for as long as a killed participant's lease runs. A new helper is sent them all.
  // Once for each participant: those that are not of ROS announce none.
  bool lacks_announcement(Time now) {
    constexpr std::size_t kMost = 1000;
    const std::vector<rtps::GuidPrefix> all = graph_.without_nodes();  // ascending
    std::erase_if(nameless_,
                  [&](const auto& each) { return !std::ranges::binary_search(all, each.first); });
    bool lacks = false;
    for (const rtps::GuidPrefix& each : all) {
      const auto since = nameless_.try_emplace(each, now).first->second;
      if (helped_for_.contains(each) || now <= later(since, kNamesCome)) continue;
      if (helped_for_.size() >= kMost) helped_for_.clear();
      helped_for_.insert(each);
      lacks = true;
    }
    return lacks;
  }

  void ask_whether_it_works(Time now) {
    asked_last_ = now;
    ours_.queue(culprit_link::Echo{});
  }

  // Everything that is there. Not empty: it ended, or means nothing.
  std::string receive(HelperProcess& process) {
    constexpr int kAtOnce = 16;  // what waits to be sent has its turn, too
    bool has_come = false;
    for (int i = 0; i < kAtOnce; ++i) {
      std::array<std::uint8_t, 65536> buffer;
      const ssize_t count = recv(process.socket(), buffer.data(), buffer.size(), 0);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) break;
      if (count <= 0) return process.end();
      has_come = true;
      reader_.feed({buffer.data(), static_cast<std::size_t>(count)});
      while (auto frame = reader_.next()) {
        std::string why = std::visit([this](auto& each) { return this->take(each); }, *frame);
        if (why.empty()) continue;
        process.end();
        return why;
      }
      if (reader_.has_failed()) {
        process.end();
        return "it sent what is no frame of the protocol";
      }
    }
    if (!has_come) return "";
    came_last_ = live_now();
    std::function<void()> on_round;
    {
      const MutexLock lock(mutex_);
      on_round = on_round_;
    }
    if (on_round) on_round();
    return "";
  }

  // ---- what the helper says; each gives why the talk is over

  std::string take(const culprit_link::Welcome& welcome) {
    if (welcome.version != culprit_link::kVersion) {
      is_final_ = true;
      return "it speaks version " + std::to_string(welcome.version) +
             " of the protocol, and culprit version " + std::to_string(culprit_link::kVersion) +
             ": install the culprit_link of this culprit's release";
    }
    if (is_joined_) return "it joined twice";
    graph_.begin(welcome.middleware, welcome.own,
                 NodeName{options_.name_space, options_.name}.full());
    is_joined_ = true;
    is_settled_ = false;
    joined_ = live_now();
    last_graph_.reset();
    ours_.begin();
    const MutexLock lock(mutex_);
    has_joined_ = true;
    changed_.notify_all();
    return "";
  }

  std::string take(const culprit_link::Arrived& sample) {
    const OursPtr ours = ours_.find(sample.id);
    if (!ours || ours->meaning.purpose != Purpose::kTopic || !ours->on_sample) return "";
    ours->came_last = live_now();
    awaited_.erase(sample.id);
    const rtps::Guid writer = graph_.writer_of(ours->topic, sample.writer);
    std::int64_t number = sample.number;
    if (number <= 0) number = ours->count(writer);  // a forged one may be beyond 2^63
    const rtps::ByteView payload(sample.payload);
    ours->gate.pass([&] {
      ours->on_sample({.payload = payload.first(given_of(ours->use, payload.size())),
                       .size = sample.size,
                       .sent = to_system_time(sample.sent),
                       .received = to_system_time(sample.received),
                       .identity = {writer, number},
                       .related = {}});
    });
    return "";
  }

  // The middleware does not say who answered: a server of the service.
  std::string take(const culprit_link::Reply& reply) {
    const OursPtr client = ours_.find(reply.id);
    if (!client || client->meaning.purpose != Purpose::kRequest) return "";
    for (const OursPtr& ours : ours_.readers_of(Purpose::kReply, client->meaning.name)) {
      const std::set<rtps::Guid>& servers =
          graph_.matching(ours->topic, rtps::EndpointRole::kReader);
      const rtps::Guid server = servers.empty() ? rtps::Guid{} : ours->newest_of(servers);
      ours->deliver(reply.payload, {server, reply.number}, {client->guid, reply.number});
    }
    return "";
  }

  std::string take(const culprit_link::Asked& asked) {
    const OursPtr server = ours_.find(asked.id);
    if (server && server->meaning.purpose == Purpose::kRequest)
      server->deliver(asked.payload, {ours_.guid(0, 0x03), asked.number}, {});
    return "";
  }

  std::string take(const culprit_link::Echo& echo) {
    // An endpoint's id is before what it wrote. Our own question is empty.
    if (echo.payload.size() < sizeof(std::uint32_t) || !is_settled_) return "";
    std::uint32_t id = 0;
    std::memcpy(&id, echo.payload.data(), sizeof id);
    const OursPtr writer = ours_.find(id);
    if (!writer || writer->meaning.purpose != Purpose::kOwn) return "";
    const rtps::ByteView payload = rtps::ByteView(echo.payload).subspan(sizeof id);
    for (const OursPtr& ours : ours_.readers_of(Purpose::kOwn, writer->meaning.name))
      ours->deliver(payload, {writer->guid, ours->count(writer->guid)}, {});
    return "";
  }

  std::string take(culprit_link::GraphSeen& seen) {
    last_graph_ = std::move(seen);
    take_graph();
    return "";
  }

  std::string take(const culprit_link::Refused& refused) {
    const OursPtr ours = ours_.find(refused.id);
    constexpr std::size_t kMost = 100;
    // Once for each reason: a missing package has many types.
    if (ours && told_.size() < kMost && told_.insert(refused.why).second)
      trouble("over --link ros culprit lacks " + ours->meaning.name + ": " +
              printable(refused.why));
    return "";
  }

  std::string take(const culprit_link::Dropped& dropped) {
    const std::uint64_t before = std::exchange(dropped_by_helper_, dropped.datagrams);
    if (dropped.datagrams > before) dropped_ += dropped.datagrams - before;
    return "";
  }

  std::string take(const culprit_link::Trouble& trouble) {
    tell_once("the helper program: " + printable(trouble.text));
    return "";
  }

  template <class Other>
  static std::string take(const Other&) {
    return "it sent a frame that only culprit sends";
  }

  // ---- the graph

  void take_graph() {
    const auto missing = is_settled_ ? HelperGraph::Missing::kLeft : HelperGraph::Missing::kKeep;
    for (HelperGraph::Change& change : graph_.take(*last_graph_, missing)) {
      if (auto* event = std::get_if<DiscoveryEvent>(&change)) {
        on_discovery_(std::move(*event));
      } else {
        deliver_info(std::get<DiscoveryInfo>(change));
      }
    }
    match();
  }

  void look_whether_settled(Time now) {
    const bool knows_all = last_graph_ && !graph_.has_missing() && awaited_.empty();
    if (is_settled_ || (!knows_all && now < later(joined_, kSettles))) return;
    is_settled_ = true;
    awaited_.clear();
    if (last_graph_) take_graph();
  }

  void deliver_info(const DiscoveryInfo& info) {
    const rtps::Bytes payload = encode_discovery_info(info, GidSize::kHumbleAndOlder);
    for (const OursPtr& ours : ours_.readers_of(Purpose::kInfos, std::string(kDiscoveryInfoTopic)))
      ours->deliver(payload, {info.participant, ours->count(info.participant)}, {});
  }

  // To a reader that came later.
  void deliver_infos() {
    if (!infos_are_due_.exchange(false)) return;
    for (const DiscoveryInfo& info : graph_.infos()) deliver_info(info);
  }

  void match() {
    for (const OursPtr& ours : ours_.all()) {
      if (ours->meaning.purpose == Purpose::kOwn || ours->meaning.purpose == Purpose::kInfos)
        continue;
      ours->match(graph_.matching(ours->topic, ours->role));
    }
  }

  // Its successor's endpoints are new ones, which servers have to discover.
  void lose_all() {
    ours_.close();
    is_settled_ = false;
    const Time now = live_now();
    for (const OursPtr& ours : ours_.all()) {
      if (now < later(ours->came_last, kFlows)) awaited_.insert(ours->id);
      ours->match({});
    }
  }

  // ---- small parts

  void sleep(Duration pause) {
    const Time until = later(live_now(), pause);
    while (!ends_ && live_now() < until) {
      pollfd file{wake_.descriptor(), POLLIN, 0};
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - live_now());
      (void)poll(&file, 1, static_cast<int>(std::max<std::int64_t>(left.count(), 1)));
      wake_.clear();
    }
  }

  void fail_first(const std::string& why) {
    const MutexLock lock(mutex_);
    if (has_joined_) return;
    failure_ = "the helper program of --link ros does not serve: " + why;
    is_final_ = true;
    changed_.notify_all();
  }

  void trouble(const std::string& text) {
    if (options_.on_trouble) options_.on_trouble(text);
  }

  void tell_once(const std::string& text) {
    constexpr std::size_t kMost = 100;
    if (told_.size() < kMost && told_.insert(text).second) trouble(text);
  }

  const HelperOptions options_;
  const DiscoveryCallback on_discovery_;
  HelperEndpoints ours_;
  const rtps::Guid guid_;
  const WakeFile wake_;
  rtps::Origins origins_;
  std::atomic<bool> ends_ = false;
  std::atomic<bool> infos_are_due_ = false;
  std::atomic<bool> rematches_ = false;     // an endpoint was added
  std::atomic<std::uint64_t> dropped_ = 0;  // datagrams, by all helpers so far

  // Of the thread.
  culprit_link::FrameReader reader_;
  HelperGraph graph_;
  std::optional<culprit_link::GraphSeen> last_graph_;  // of this helper
  std::uint64_t dropped_by_helper_ = 0;                // datagrams, as this one reported last
  Time came_last_ = kLongAgo;
  Time asked_last_ = kLongAgo;
  Time joined_ = kLongAgo;
  bool is_joined_ = false;
  bool is_settled_ = false;          // it has discovered what was known before
  std::set<std::uint32_t> awaited_;  // of our readers: samples came before the last helper's end
  bool is_final_ = false;            // no other one would do better
  std::set<std::string> told_;
  std::map<rtps::GuidPrefix, Time> nameless_;  // participants without a node, since when
  std::set<rtps::GuidPrefix> helped_for_;      // those of them for which a helper was replaced
  SeldomTimes replaced_;                       // for them

  Mutex mutex_;
  ConditionVariable changed_;
  bool has_joined_ CULPRIT_GUARDED_BY(mutex_) = false;  // once
  std::optional<std::string> failure_ CULPRIT_GUARDED_BY(mutex_);
  std::function<void()> on_round_ CULPRIT_GUARDED_BY(mutex_);

  std::thread thread_;
};

class HelpedReader final : public Reader::Impl {
 public:
  HelpedReader(Helped& participant, std::shared_ptr<Ours> ours)
      : participant_(participant), ours_(std::move(ours)) {}
  ~HelpedReader() override {
    ours_->gate.close();
    participant_.remove(*ours_);
  }
  const rtps::Guid& guid() const override { return ours_->guid; }

 private:
  Helped& participant_;
  const std::shared_ptr<Ours> ours_;
};

class HelpedWriter final : public Writer::Impl {
 public:
  HelpedWriter(Helped& participant, std::shared_ptr<Ours> ours)
      : participant_(participant), ours_(std::move(ours)) {}
  ~HelpedWriter() override {
    ours_->gate.close();
    participant_.remove(*ours_);
  }
  const rtps::Guid& guid() const override { return ours_->guid; }
  std::optional<std::int64_t> write(rtps::ByteView payload,
                                    const rtps::SampleIdentity& related) override {
    return participant_.write(*ours_, payload, related);
  }
  void forget_unacknowledged() override {}
  bool is_acknowledged() const override { return true; }

 private:
  Helped& participant_;
  const std::shared_ptr<Ours> ours_;
};

Expected<std::unique_ptr<Reader>> Helped::create_reader(ReaderOptions options,
                                                        SampleCallback on_sample) {
  auto ours = ours_.add(rtps::EndpointRole::kReader, options.topic, options.type, options.qos,
                        options.payload, std::move(on_sample), std::move(options.on_match));
  if (!ours) return Error{ours.error()};
  added(**ours);
  return std::make_unique<Reader>(std::make_unique<HelpedReader>(*this, std::move(*ours)));
}

Expected<std::unique_ptr<Writer>> Helped::create_writer(WriterOptions options) {
  auto ours = ours_.add(rtps::EndpointRole::kWriter, options.topic, options.type, options.qos,
                        PayloadUse::kWhole, {}, std::move(options.on_match));
  if (!ours) return Error{ours.error()};
  added(**ours);
  return std::make_unique<Writer>(std::make_unique<HelpedWriter>(*this, std::move(*ours)));
}

}  // namespace

Expected<std::unique_ptr<Participant::Impl>> HelperParticipant::join(
    HelperOptions options, DiscoveryCallback on_discovery) {
  auto helped = std::make_unique<Helped>(std::move(options), std::move(on_discovery));
  if (auto opened = helped->open(); !opened) return Error{opened.error()};
  return std::unique_ptr<Participant::Impl>(std::move(helped));
}

}  // namespace culprit::ros2
