#include "ros2/service_client.h"

#include <algorithm>
#include <chrono>

#include "ros2/names.h"
#include "rtps/receive_thread.h"

namespace culprit::ros2 {
namespace {

constexpr Duration kSoonestAgain = std::chrono::milliseconds(200);
constexpr Duration kLatestAgain = std::chrono::seconds(2);
constexpr std::chrono::seconds kProbeTimeout(10);  // then another one begins

Executor::Clock::time_point after(Duration d) {
  const auto now = Executor::Clock::now();
  return d > Executor::Clock::time_point::max() - now ? Executor::Clock::time_point::max()
                                                      : now + d;
}

}  // namespace

Expected<std::unique_ptr<ServiceClient>> ServiceClient::create(NodeEntry& node,
                                                               const ServiceName& service,
                                                               const rtps::Qos& qos,
                                                               rtps::Haste haste) {
  std::unique_ptr<ServiceClient> client(new ServiceClient(node));
  if (auto opened = client->open(service, qos, haste); !opened) return Error{opened.error()};
  return client;
}

Expected<std::unique_ptr<ServiceClient>> ServiceClient::create(NodeEntry& node,
                                                               const ServiceName& service,
                                                               const rtps::Qos& qos, Probe probe) {
  auto client = create(node, service, qos);
  if (!client) return client;
  // Second: data that the server discovers later prove that it discovered the earlier ones.
  if (auto opened = (*client)->open_probe(std::move(probe)); !opened) return Error{opened.error()};
  return client;
}

ServiceClient::ServiceClient(NodeEntry& node)
    : node_(node),
      again_after_(kSoonestAgain),
      tasks_(node.context().executor()),
      update_servers_soon_(tasks_, [this] { update_servers(); }) {}

// A client with kSoon repeats a request itself if it is lost, so answers need no acknowledgements.
// And only the last request is kept, so that Fast DDS asks for the acknowledgement of each with the
// request itself.
Expected<void> ServiceClient::open(const ServiceName& service, const rtps::Qos& qos,
                                   rtps::Haste haste) {
  if (!is_valid_topic_name(service.name))
    return Error{"'" + printable(service.name) + "' is not the name of a service"};
  if (!is_valid_type_name(service.type))
    return Error{"'" + printable(service.type) + "' is not the type of a service"};
  Participant& participant = node_.context().participant();
  const std::string user_data = "clientid=" + node_.context().unique_id() + ";";
  rtps::Qos answers = qos;
  rtps::Qos requests = qos;
  if (haste == rtps::Haste::kSoon) {
    answers.reliability = rtps::Reliability::kBestEffort;
    requests.depth = 1;
  }

  auto reader = participant.create_reader(
      {.topic = mangle_topic(Channel::kReply, service.name),
       .type = mangle_type(Channel::kReply, service.type),
       .qos = answers,
       .payload = haste == rtps::Haste::kSoon ? PayloadUse::kWholeLater : PayloadUse::kWhole,
       .user_data = user_data,
       .on_match =
           [this](const rtps::Guid& remote, Match match) {
             tasks_.post([this, remote, match] { on_reply_writer(remote, match); });
           }},
      [this](const Sample& sample) { on_reply(sample); });
  if (!reader) return Error{reader.error()};
  reply_reader_ = std::move(*reader);
  node_.add(reply_reader_->guid());

  auto writer = participant.create_writer(
      {.topic = mangle_topic(Channel::kRequest, service.name),
       .type = mangle_type(Channel::kRequest, service.type),
       .qos = requests,
       .user_data = user_data,
       .on_match =
           [this](const rtps::Guid& remote, Match match) {
             tasks_.post([this, remote, match] { on_request_reader(remote, match); });
           },
       .haste = haste});
  if (!writer) return Error{writer.error()};
  const rtps::Guid guid = (*writer)->guid();
  node_.add(guid);
  {
    const MutexLock lock(mutex_);  // from now on a server may match, and a task of ours send
    request_writer_ = std::move(*writer);
    reader_id_ = reply_reader_->guid();
    writer_id_ = guid;
    header_id_ = std::hash<rtps::Guid>()(guid);
  }
  node_.context().watch_servers(this, service.name, [this] { on_server_left(); });
  return {};
}

Expected<void> ServiceClient::open_probe(Probe probe) {
  auto client = create(node_, probe.service, rtps::qos::kServices, rtps::Haste::kSoon);
  if (!client) return Error{client.error()};
  {
    const MutexLock lock(mutex_);
    probe_request_ = std::move(probe.request);
    probe_ = std::move(*client);
  }
  tasks_.post([this] { start_probe(); });  // servers may have come already
  return {};
}

ServiceClient::~ServiceClient() {
  node_.context().unwatch_servers(this);
  tasks_.close();
  probe_.reset();  // its callbacks use the rest
  if (reply_reader_) node_.remove(reply_reader_->guid());
  if (request_writer_) node_.remove(request_writer_->guid());
  reply_reader_.reset();
  request_writer_.reset();
}

void ServiceClient::call(rtps::Bytes request, Repeat repeat, Duration timeout, Callback callback,
                         rtps::Haste haste) {
  const MutexLock lock(mutex_);
  const CallNumber number = ++last_call_;
  Call& call = calls_[number];
  call.request = std::move(request);
  call.repeat = repeat;
  call.callback = std::move(callback);
  if (server_for(repeat) != nullptr) send(number, call);
  // An answer that came in time may still lie in its socket.
  const Duration patience =
      haste == rtps::Haste::kSoon ? timeout + rtps::ReceiveThread::kSoon : timeout;
  call.deadline = tasks_.post_at(after(patience), [this, number] { on_deadline(number); });
  if (repeat == Repeat::kUntilAnswered) {
    call.next_send = tasks_.post_at(after(again_after_), [this, number] { on_send_again(number); });
  }
  if (haste == rtps::Haste::kNow)
    call.hurry = std::make_unique<Participant::Hurry>(node_.context().participant());
}

void ServiceClient::ask_only(const rtps::GuidPrefix& participant) {
  {
    const MutexLock lock(mutex_);
    if (only_ == participant) return;
    only_ = participant;
    if (proven_ && proven_->participant != participant) lose_proof();
    std::erase_if(servers_, [&](const Server& each) { return each.participant != participant; });
  }
  if (probe_) probe_->ask_only(participant);
  tasks_.post([this] { update_servers(); });
}

bool ServiceClient::is_ready() const {
  const MutexLock lock(mutex_);
  return server_for(Repeat::kNever) != nullptr;
}

const ServiceClient::Server* ServiceClient::server_for(Repeat repeat) const {
  if (repeat == Repeat::kNever && probe_ != nullptr) return proven_ ? &*proven_ : nullptr;
  if (servers_.empty()) return nullptr;
  return proven_ ? &*proven_ : &servers_.back();
}

// The mutex is held over the write: the reply can be here before write() returns.
void ServiceClient::send(CallNumber number, Call& call) {
  const Server& server = *server_for(call.repeat);
  std::optional<std::int64_t> sequence;
  if (server.mapping == Mapping::kHeader) {
    const ServiceHeader header{header_id_, ++header_sequence_};
    if (request_writer_->write(with_header(call.request, header))) sequence = header.sequence;
  } else {
    sequence = request_writer_->write(call.request, {.writer = reader_id_, .sequence = 0});
  }
  if (!sequence) return;
  call.is_sent = true;
  requests_.emplace(RequestId{server.mapping, *sequence}, Sending{number, Executor::Clock::now()});
}

std::optional<ServiceClient::Call> ServiceClient::take(CallNumber number) {
  const auto found = calls_.find(number);
  if (found == calls_.end()) return std::nullopt;
  std::optional<Call> call(std::move(found->second));
  calls_.erase(found);
  std::erase_if(requests_, [number](const auto& request) { return request.second.call == number; });
  tasks_.cancel(call->deadline);
  tasks_.cancel(call->next_send);
  return call;
}

// Every client of a service gets every reply.
void ServiceClient::on_reply(const Sample& sample) {
  RequestId id;
  std::optional<SplitPayload> split;
  if (sample.related.writer != rtps::Guid{}) {
    id = {Mapping::kInline, sample.related.sequence};
  } else {
    split = split_header(sample.payload);
    if (!split) return;
    id = {Mapping::kHeader, split->header.sequence};
  }
  std::optional<Call> call;
  {
    const MutexLock lock(mutex_);
    const bool is_ours =
        split ? split->header.client == header_id_
              : sample.related.writer == reader_id_ || sample.related.writer == writer_id_;
    const auto request = requests_.find(id);
    if (!is_ours || request == requests_.end()) return;
    if (only_ && sample.identity.writer.prefix() != *only_) return;
    const Duration took = Executor::Clock::now() - request->second.at;
    again_after_ = std::clamp(2 * took, kSoonestAgain, kLatestAgain);
    call = take(request->second.call);
  }
  call->callback({.outcome = CallOutcome::kAnswered,
                  .reply = split ? rtps::ByteView(split->payload) : sample.payload,
                  .server = sample.identity.writer.prefix()});
}

void ServiceClient::on_request_reader(const rtps::Guid& reader, Match match) {
  if (match == Match::kMade) {
    request_readers_.emplace(reader, ++matches_);
    // Requests that an exited server did not acknowledge must not delay those to its successor
    // (service_mapping.h).
    const MutexLock lock(mutex_);
    if (request_writer_) request_writer_->forget_unacknowledged();
  } else {
    request_readers_.erase(reader);
  }
  update_servers_soon_.post();
}

void ServiceClient::on_reply_writer(const rtps::Guid& writer, Match match) {
  if (match == Match::kMade) {
    reply_writers_.emplace(writer, ++matches_);
  } else {
    reply_writers_.erase(writer);
  }
  update_servers_soon_.post();
}

void ServiceClient::update_servers() {
  const Graph& graph = node_.context().graph();
  const std::vector<rtps::GuidPrefix> all =
      servers_among(request_readers_, reply_writers_, [&graph](const rtps::Guid& guid) {
        const rtps::EndpointInfo* info = graph.endpoint(guid);
        return info == nullptr ? std::string_view() : user_data_value(info->user_data, "serviceid");
      });
  {
    const MutexLock lock(mutex_);
    const auto is_known = [](const std::vector<Server>& servers,
                             const rtps::GuidPrefix& participant) {
      return std::ranges::find(servers, participant, &Server::participant) != servers.end();
    };
    const std::vector<Server> before = std::move(servers_);
    servers_.clear();
    bool has_new = false;
    for (const rtps::GuidPrefix& each : all) {
      if (only_ && each != *only_) continue;
      has_new = has_new || !is_known(before, each);
      servers_.push_back({each, mapping_of(graph.participant(each))});
    }
    // A new server may be the successor of the one that proved to know us and has exited.
    if (has_new || (proven_ && !is_known(servers_, proven_->participant))) lose_proof();
    for (auto& [number, call] : calls_) {
      if (has_new && call.repeat == Repeat::kUntilAnswered) send(number, call);
    }
  }
  start_probe();
  send_waiting();
}

// It may have been ours. If ours still runs, it will prove it.
void ServiceClient::on_server_left() {
  {
    const MutexLock lock(mutex_);
    lose_proof();
  }
  tasks_.post([this] { start_probe(); });
}

void ServiceClient::send_waiting() {
  const MutexLock lock(mutex_);
  if (!request_writer_) return;
  for (auto& [number, call] : calls_) {
    if (!call.is_sent && server_for(call.repeat) != nullptr) send(number, call);
  }
}

void ServiceClient::lose_proof() {
  proven_.reset();
  ++proof_round_;
}

void ServiceClient::start_probe() {
  std::uint64_t round = 0;
  {
    const MutexLock lock(mutex_);
    if (probe_ == nullptr || is_probing_ || servers_.empty() || proven_) return;
    round = proof_round_;
  }
  is_probing_ = true;
  // A caller that waits for the proof hastens it (call()).
  probe_->call(
      probe_request_, Repeat::kUntilAnswered, kProbeTimeout,
      [this, round](const CallResult& result) {
        tasks_.post([this, round, outcome = result.outcome, server = result.server] {
          on_probe(round, outcome, server);
        });
      },
      rtps::Haste::kSoon);
}

void ServiceClient::on_probe(std::uint64_t round, CallOutcome outcome,
                             const rtps::GuidPrefix& participant) {
  is_probing_ = false;
  if (outcome != CallOutcome::kAnswered) return start_probe();
  {
    const MutexLock lock(mutex_);
    if (round != proof_round_) return tasks_.post([this] { start_probe(); });
    const auto server = std::ranges::find(servers_, participant, &Server::participant);
    if (server != servers_.end()) proven_ = *server;
  }
  send_waiting();
  // If that was a server of the probe only, ask again: the others of its endpoints are still to
  // come.
  tasks_.post_at(after(kSoonestAgain), [this] { start_probe(); });
}

void ServiceClient::on_send_again(CallNumber number) {
  const MutexLock lock(mutex_);
  const auto found = calls_.find(number);
  if (found == calls_.end()) return;
  if (server_for(Repeat::kUntilAnswered) != nullptr) send(number, found->second);
  found->second.next_send =
      tasks_.post_at(after(again_after_), [this, number] { on_send_again(number); });
}

void ServiceClient::on_deadline(CallNumber number) {
  std::optional<Call> call;
  {
    const MutexLock lock(mutex_);
    call = take(number);
  }
  if (!call) return;
  call->callback({.outcome = call->is_sent ? CallOutcome::kTimedOut : CallOutcome::kUnreachable,
                  .reply = {},
                  .server = {}});
}

}  // namespace culprit::ros2
