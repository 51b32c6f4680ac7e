#include "ros2/context.h"

#include <chrono>
#include <utility>

#include "base/invariant.h"
#include "base/live_clock.h"
#include "ros2/helper_graph.h"
#include "ros2/process_finder.h"
#include "ros2/type_description.h"
#include "rtps/origins.h"
#include "rtps/own_addresses.h"

namespace culprit::ros2 {
namespace {

// How long peers are given to show the size of their gids before ours is taken to be the old one.
// Theirs comes within milliseconds of discovery, unless a packet is lost.
constexpr std::chrono::milliseconds kPatience(250);

}  // namespace

Expected<std::unique_ptr<Context>> Context::create(Executor& executor,
                                                   const ParticipantOptions& options,
                                                   Graph::Options graph) {
  std::unique_ptr<Context> context(new Context(executor, std::move(graph)));
  if (auto opened = context->open(options); !opened) return Error{opened.error()};
  return context;
}

Context::Context(Executor& executor, Graph::Options graph)
    : executor_(executor), graph_(with_context(std::move(graph))), tasks_(executor) {}

Graph::Options Context::with_context(Graph::Options options) {
  options.listener = [this, listener = std::move(options.listener)](const GraphChange& change) {
    const auto* left = std::get_if<EndpointLeft>(&change);
    if (left != nullptr && left->kind == EndpointKind::kServer) on_server_left(left->name);
    if (listener) listener(change);
  };
  options.source_of = [this](const ParticipantInfo& info) { return source_of(info); };
  if (options.find_process) {
    options.find_process = [this, find = std::move(options.find_process)](ParticipantInfo info) {
      return this->find_process(find, std::move(info));
    };
  }
  return options;
}

// Behind a discovery server all come from one address.
std::string Context::source_of(const ParticipantInfo& info) const {
  if (has_helper_) return HelperGraph::source_of(info);
  if (has_server_) return "";
  const std::vector<rtps::UdpAddress> from = participant_->origin_of(info.guid.prefix()).addresses;
  if (from.empty()) return "unknown";
  const auto& ip = from.front().ip;
  if (ip[0] == 127 || rtps::own_addresses().contains(ip)) return "";
  std::string text;
  for (const std::uint8_t part : ip) text += (text.empty() ? "" : ".") + std::to_string(part);
  return text;
}

// To look through the sockets and processes of a machine takes a millisecond or more. A socket changes
// its process only with the participant's end.
FoundProcess Context::find_process(const Graph::FindProcess& find, ParticipantInfo info) {
  constexpr Duration kLasts = std::chrono::seconds(1);
  const Time now = live_now();
  info.origin = participant_->origin_of(info.guid.prefix());
  std::erase_if(proofs_, [&](const auto& each) { return each.second.until <= now; });
  const auto known = proofs_.find(info.guid.prefix());
  if (known != proofs_.end() && known->second.of.metatraffic == info.metatraffic &&
      known->second.of.origin == info.origin)
    return known->second.found;
  FoundProcess found = find(info);
  if (found.pid != 0) {
    participant_->prove(info.guid.prefix(), found.pid);
    proofs_.insert_or_assign(info.guid.prefix(), Proof{std::move(info), found, later(now, kLasts)});
  } else if (!participant_->origins().is_proven(info.guid.prefix())) {
    // Others speak in its name, too. From now on only its process counts, and it is discovered again.
    const int speaker = ProcessFinder().speaker(info);
    if (speaker != 0) participant_->prove(info.guid.prefix(), speaker);
  }
  return found;
}

Expected<void> Context::open(const ParticipantOptions& options) {
  gid_size_ = options.gid_size;
  has_server_ = !options.servers.empty();
  has_helper_ = options.helper != nullptr;
  auto participant =
      Participant::create(options, [this](DiscoveryEvent event) { hear(std::move(event)); });
  if (!participant) return Error{participant.error()};
  participant_ = std::move(*participant);

  auto writer = participant_->create_writer({.topic = std::string(kDiscoveryInfoTopic),
                                             .type = std::string(kDiscoveryInfoType),
                                             .qos = rtps::qos::kDiscoveryInfoWriter,
                                             .user_data = {},
                                             .on_match = {}});
  if (!writer) return Error{writer.error()};
  info_writer_ = std::move(*writer);
  if (const auto listens = listen_to_infos(); !listens) return listens;
  {
    const MutexLock lock(mutex_);
    is_open_ = true;
  }
  schedule_announcement();  // the first peer may have come meanwhile
  return {};
}

Expected<void> Context::listen_to_infos() {
  auto reader = participant_->create_reader(
      {.topic = std::string(kDiscoveryInfoTopic),
       .type = std::string(kDiscoveryInfoType),
       .qos = rtps::qos::kDiscoveryInfoReader,
       .user_data = {},
       .on_match = {}},
      [this](const Sample& sample) {
        hear(RawInfo{rtps::Bytes(sample.payload.begin(), sample.payload.end()),
                     sample.identity.writer.prefix()});
      });
  if (!reader) return Error{reader.error()};
  info_reader_ = std::move(*reader);
  return {};
}

// A participant that was lost and comes back announces its nodes once more, and its writer's number
// of that is still the same: Fast DDS takes it for received (2.9,
// RTPSReader::remove_persistence_guid()). Only a new reader receives it. Others may have lost us,
// too.
void Context::note_return(const DiscoveryEvent& event) {
  constexpr std::size_t kMost = 1000;
  constexpr auto kTogether = std::chrono::milliseconds(50);  // those of one computer
  if (const auto* gone = std::get_if<ParticipantGone>(&event)) {
    if (gone->was_lost && lost_.size() < kMost) lost_.insert(gone->guid.prefix());
  } else if (const auto* there = std::get_if<ParticipantInfo>(&event)) {
    if (lost_.erase(there->guid.prefix()) == 0 || std::exchange(is_listening_anew_, true)) return;
    tasks_.post_at(Executor::Clock::now() + kTogether, [this] {
      is_listening_anew_ = false;
      (void)listen_to_infos();  // if there is no new one, the old one stays
      announce();
    });
  }
}

Context::~Context() {
  CULPRIT_ASSERT(nodes_.empty());
  tasks_.close();
}

std::string Context::unique_id() {
  std::uint32_t number = 0;
  {
    const MutexLock lock(mutex_);
    number = next_id_++;
  }
  rtps::Guid id = participant_->guid();
  for (std::size_t i = 15; i >= 12; --i, number >>= 8)
    id.bytes[i] = static_cast<std::uint8_t>(number);
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : id.bytes) {  // as rmw_cyclonedds writes its own: "1.f.a3.0"
    if (!text.empty()) text += '.';
    if (byte >= 16) text += kDigits[byte / 16];
    text += kDigits[byte % 16];
  }
  return text;
}

void Context::forget_process(int pid) {
  tasks_.post([this, pid] { graph_.forget_process(pid); });
}

void Context::forget_ended_namesakes() {
  tasks_.post([this] { graph_.forget_ended_namesakes(); });
}

void Context::believe_left(const std::string& node) {
  tasks_.post([this, node] { graph_.believe_left(node); });
}

void Context::note_proven_here(const std::string& node) {
  tasks_.post([this, node] { graph_.note_proven_here(node); });
}

void Context::look_at_unproven() {
  tasks_.post([this] { graph_.look_at_unproven(); });
}

void Context::watch_servers(const void* owner, std::string service, std::function<void()> on_left) {
  const MutexLock lock(mutex_);
  watches_.insert_or_assign(owner, ServerWatch{std::move(service), std::move(on_left)});
}

void Context::unwatch_servers(const void* owner) {
  const MutexLock lock(mutex_);
  watches_.erase(owner);
}

// With the mutex, so that no listener is called whose unwatch_servers has returned.
void Context::on_server_left(const std::string& service) {
  const MutexLock lock(mutex_);
  for (const auto& [owner, watch] : watches_) {
    if (watch.service == service) watch.on_left();
  }
}

// Robots are discovered in bursts of hundreds of endpoints: events that came meanwhile are taken in
// together. Never later than a task that was posted after it, for a match's listener looks into the
// graph.
void Context::hear(Heard heard) {
  {
    const MutexLock lock(mutex_);
    heard_.push_back(std::move(heard));
    if (heard_.size() > 1) return;
  }
  tasks_.post([this] { take_in(); });
}

void Context::take_in() {
  std::vector<Heard> all;
  {
    const MutexLock lock(mutex_);
    all.swap(heard_);
  }
  for (const Heard& each : all) {
    if (const auto* event = std::get_if<DiscoveryEvent>(&each)) {
      discovered(*event);
    } else {
      const RawInfo& info = std::get<RawInfo>(each);
      on_info(info.payload, info.sender);
    }
  }
}

void Context::discovered(const DiscoveryEvent& event) {
  graph_.apply(event);
  note_return(event);
  if (discovery_listener_) discovery_listener_(event);
  const auto* endpoint = std::get_if<rtps::EndpointInfo>(&event);
  if (endpoint == nullptr || gid_size_) return;
  // Iron and newer put the hash of the type into the user data of every endpoint. So does a culprit
  // on any robot.
  if (endpoint->user_data.find("typehash=") != std::string::npos &&
      !is_of_culprit(endpoint->user_data))
    return decide(GidSize::kIronAndNewer);
  if (endpoint->topic != kDiscoveryInfoTopic || std::exchange(is_deciding_, true)) return;
  tasks_.post_at(Executor::Clock::now() + kPatience, [this] {
    if (!gid_size_) decide(GidSize::kHumbleAndOlder);
  });
}

void Context::on_info(const rtps::Bytes& payload, const rtps::GuidPrefix& sender) {
  if (sender == participant_->guid().prefix()) return;
  const auto info = decode_discovery_info(payload);
  if (!info || info->participant.prefix() != sender) return;  // a participant announces only itself
  if (!gid_size_) decide(gid_size_of(payload));
  graph_.apply(*info, gid_size_of(payload));
}

void Context::decide(GidSize size) {
  gid_size_ = size;
  announce();
}

void Context::schedule_announcement() {
  {
    const MutexLock lock(mutex_);
    if (std::exchange(is_scheduled_, true)) return;
  }
  tasks_.post([this] { announce(); });
}

void Context::announce() {
  DiscoveryInfo info;
  {
    const MutexLock lock(mutex_);
    is_scheduled_ = false;
    if (!is_open_ || !gid_size_) return;  // without a peer it has no reader
    info.participant = participant_->guid();
    for (const NodeEntry* node : nodes_) {
      NodeEntities& entities =
          info.nodes.emplace_back(NodeEntities{node->name_.name_space, node->name_.name, {}, {}});
      for (const rtps::Guid& endpoint : node->endpoints_) {
        (endpoint.is_reader() ? entities.readers : entities.writers).push_back(endpoint);
      }
    }
  }
  info_writer_->write(encode_discovery_info(info, *gid_size_));
}

NodeEntry::NodeEntry(Context& context, NodeName name) : context_(context), name_(std::move(name)) {
  {
    const MutexLock lock(context_.mutex_);
    context_.nodes_.insert(this);
  }
  context_.schedule_announcement();
}

NodeEntry::~NodeEntry() {
  {
    const MutexLock lock(context_.mutex_);
    context_.nodes_.erase(this);
  }
  context_.schedule_announcement();
}

void NodeEntry::add(const rtps::Guid& endpoint) {
  {
    const MutexLock lock(context_.mutex_);
    endpoints_.insert(endpoint);
  }
  context_.schedule_announcement();
}

void NodeEntry::remove(const rtps::Guid& endpoint) {
  {
    const MutexLock lock(context_.mutex_);
    endpoints_.erase(endpoint);
  }
  context_.schedule_announcement();
}

}  // namespace culprit::ros2
