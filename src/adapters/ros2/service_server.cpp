#include "ros2/service_server.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "ros2/names.h"
#include "ros2/type_description.h"

namespace culprit::ros2 {
namespace {

using namespace std::chrono_literals;

constexpr auto kLongestWait = 5s;
constexpr auto kBetweenLooks = 1ms;

}  // namespace

Expected<std::unique_ptr<ServiceServer>> ServiceServer::create(NodeEntry& node,
                                                               const ServiceName& service,
                                                               const rtps::Qos& qos,
                                                               Handler handler) {
  return create_any(node, service, qos, std::move(handler), {});
}

Expected<std::unique_ptr<ServiceServer>> ServiceServer::create_slow(NodeEntry& node,
                                                                    const ServiceName& service,
                                                                    const rtps::Qos& qos,
                                                                    SlowHandler handler,
                                                                    const ServiceHashes& hashes) {
  return create_any(node, service, qos, std::move(handler), hashes);
}

Expected<std::unique_ptr<ServiceServer>> ServiceServer::create_any(NodeEntry& node,
                                                                   const ServiceName& service,
                                                                   const rtps::Qos& qos,
                                                                   AnyHandler handler,
                                                                   const ServiceHashes& hashes) {
  std::unique_ptr<ServiceServer> server(new ServiceServer(node, std::move(handler), qos.depth));
  if (auto opened = server->open(service, qos, hashes); !opened) return Error{opened.error()};
  return server;
}

ServiceServer::ServiceServer(NodeEntry& node, AnyHandler handler, std::size_t depth)
    : node_(node),
      handler_(std::move(handler)),
      late_(std::make_shared<Late>()),
      depth_(depth),
      tasks_(node.context().executor()) {
  const MutexLock lock(late_->mutex);
  late_->server = this;
}

Expected<void> ServiceServer::open(const ServiceName& service, const rtps::Qos& qos,
                                   const ServiceHashes& hashes) {
  if (!is_valid_topic_name(service.name))
    return Error{"'" + printable(service.name) + "' is not the name of a service"};
  if (!is_valid_type_name(service.type))
    return Error{"'" + printable(service.type) + "' is not the type of a service"};
  Participant& participant = node_.context().participant();
  const std::string id = "serviceid=" + node_.context().unique_id() + ";";

  auto writer =
      participant.create_writer({.topic = mangle_topic(Channel::kReply, service.name),
                                 .type = mangle_type(Channel::kReply, service.type),
                                 .qos = qos,
                                 .user_data = id + type_user_data(hashes.response, hashes.service),
                                 .on_match = [this](const rtps::Guid& reader, Match match) {
                                   tasks_.post([this, reader, match] { on_match(reader, match); });
                                 }});
  if (!writer) return Error{writer.error()};
  reply_writer_ = std::move(*writer);
  node_.add(reply_writer_->guid());

  auto reader = participant.create_reader(
      {.topic = mangle_topic(Channel::kRequest, service.name),
       .type = mangle_type(Channel::kRequest, service.type),
       .qos = qos,
       .user_data = id + type_user_data(hashes.request, hashes.service),
       .on_match = {}},
      [this](const Sample& sample) {
        {
          const MutexLock lock(mutex_);
          if (requests_.size() >= depth_) requests_.pop_front();  // as a history of that depth does
          requests_.push_back(
              {{sample.payload.begin(), sample.payload.end()}, sample.identity, sample.related});
        }
        tasks_.post([this] { handle_next(); });
      });
  if (!reader) return Error{reader.error()};
  request_reader_ = std::move(*reader);
  node_.add(request_reader_->guid());
  return {};
}

ServiceServer::~ServiceServer() {
  {
    const MutexLock lock(late_->mutex);
    late_->server = nullptr;
  }
  tasks_.close();
  if (request_reader_) node_.remove(request_reader_->guid());
  if (reply_writer_) node_.remove(reply_writer_->guid());
  request_reader_.reset();
  reply_writer_.reset();
}

void ServiceServer::handle_next() {
  Request request;
  {
    const MutexLock lock(mutex_);
    if (requests_.empty()) return;
    request = std::move(requests_.front());
    requests_.pop_front();
  }
  const auto* client = node_.context().graph().participant(request.identity.writer.prefix());
  auto call = mapping_of(client) == Mapping::kHeader ? read_header(request) : read_inline(request);
  if (!call) return;
  if (const auto* handler = std::get_if<Handler>(&handler_)) {
    call->reply.payload = (*handler)(call->request);
    return deliver(std::move(call->reply));
  }
  std::get<SlowHandler>(handler_)(call->request, answer_to(std::move(call->reply)));
}

ServiceServer::Answer ServiceServer::answer_to(Reply reply) {
  return [late = late_, reply = std::move(reply)](rtps::Bytes payload) {
    const MutexLock lock(late->mutex);
    ServiceServer* const server = late->server;
    if (server == nullptr) return;
    Reply whole = reply;
    whole.payload = std::move(payload);
    server->tasks_.post([server, whole = std::move(whole)] { server->deliver(whole); });
  };
}

void ServiceServer::deliver(Reply reply) {
  if (reply.payload.empty()) return;
  if (is_expected(reply) && has_greeted(reply)) return send(reply);
  const std::uint64_t number = next_waiting_++;
  waiting_.emplace(number, std::move(reply));
  // Then the client has left, or will never receive it; nothing is to be done about either.
  tasks_.post_at(Executor::Clock::now() + kLongestWait, [this, number] { waiting_.erase(number); });
}

std::optional<ServiceServer::Call> ServiceServer::read_inline(const Request& request) const {
  Reply reply;
  const bool names_reader = request.related.writer != rtps::Guid{};
  const rtps::Guid client = names_reader ? request.related.writer : request.identity.writer;
  reply.related = {client, request.identity.sequence};
  if (client.is_reader()) reply.reader = client;
  return Call{request.payload, std::move(reply)};
}

std::optional<ServiceServer::Call> ServiceServer::read_header(const Request& request) const {
  auto split = split_header(request.payload);
  if (!split) return std::nullopt;
  Reply reply;
  reply.header = split->header;
  const rtps::EndpointInfo* writer = node_.context().graph().endpoint(request.identity.writer);
  const auto id =
      writer == nullptr ? std::string_view() : user_data_value(writer->user_data, "clientid");
  if (!id.empty()) reply.reader = std::string(id);
  return Call{std::move(split->payload), std::move(reply)};
}

// Whether the reader that the reply is for has matched, as far as the client named it.
bool ServiceServer::is_expected(const Reply& reply) const {
  if (const auto* guid = std::get_if<rtps::Guid>(&reply.reader))
    return reply_readers_.contains(*guid);
  const auto* id = std::get_if<std::string>(&reply.reader);
  if (id == nullptr) return true;
  const Graph& graph = node_.context().graph();
  return std::ranges::any_of(reply_readers_, [&](const rtps::Guid& guid) {
    const rtps::EndpointInfo* reader = graph.endpoint(guid);
    return reader != nullptr && user_data_value(reader->user_data, "clientid") == *id;
  });
}

// Whether the first sample to a reader on Cyclone, which may be lost (service_mapping.h), is behind
// us. It is addressed to no client, and the reply follows once it was acknowledged: sent at once,
// both may be announced by the same heartbeat.
bool ServiceServer::has_greeted(const Reply& reply) {
  if (!reply.header) return true;
  const auto now = Executor::Clock::now();
  if (has_fresh_reader_) {
    has_fresh_reader_ = false;
    reply_writer_->write(with_header(reply.payload, ServiceHeader{}));
    greeting_ends_ = now + kLongestGreeting;
    tasks_.post_at(now + kBetweenLooks, [this] { look_at_greeting(); });
  }
  return !greeting_ends_;
}

void ServiceServer::look_at_greeting() {
  if (!greeting_ends_) return;
  const auto now = Executor::Clock::now();
  if (now < *greeting_ends_ && !reply_writer_->is_acknowledged()) {
    tasks_.post_at(now + kBetweenLooks, [this] { look_at_greeting(); });
    return;
  }
  greeting_ends_.reset();
  send_waiting();
}

void ServiceServer::send(const Reply& reply) {
  if (reply.header) {
    reply_writer_->write(with_header(reply.payload, *reply.header));
  } else {
    reply_writer_->write(reply.payload, reply.related);
  }
}

void ServiceServer::send_waiting() {
  std::erase_if(waiting_, [this](const auto& waiting) {
    if (!is_expected(waiting.second) || !has_greeted(waiting.second)) return false;
    send(waiting.second);
    return true;
  });
}

void ServiceServer::on_match(const rtps::Guid& reader, Match match) {
  if (match == Match::kLost) {
    reply_readers_.erase(reader);
    return;
  }
  reply_readers_.insert(reader);
  has_fresh_reader_ = true;
  send_waiting();
}

}  // namespace culprit::ros2
