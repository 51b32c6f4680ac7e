// Offers a service to clients on Fast DDS and on Cyclone DDS at once (service_mapping.h).
//
// A request is handled on the executor's thread. A reply that is sent before the client's reply
// reader has matched would be lost. So it waits for the match, up to 5 s, and delays nothing else.
// Both rmw implementations wait 100 ms, for they do hold up what comes next; on a busy machine that
// loses replies.
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <variant>

#include "base/expected.h"
#include "base/mutex.h"
#include "ros2/context.h"
#include "ros2/executor.h"
#include "ros2/participant.h"
#include "ros2/service_client.h"
#include "ros2/service_mapping.h"
#include "rtps/cdr.h"

namespace culprit::ros2 {

// The hashes that identify the types of a service (type_description.h); empty: not announced.
struct ServiceHashes {
  std::string request{};
  std::string response{};
  std::string service{};
};

class ServiceServer {
 public:
  // Request payload to reply payload, both with their encapsulation. An empty reply is none: the
  // request was malformed.
  using Handler = std::function<rtps::Bytes(rtps::ByteView request)>;
  // For a handler that needs time: the answer is given when it is there, once, from any thread. If
  // it comes after the server was destroyed, it is dropped.
  using Answer = std::function<void(rtps::Bytes reply)>;
  using SlowHandler = std::function<void(rtps::ByteView request, Answer answer)>;
  // A first reply to a client on Cyclone waits so long for the acknowledgement of its greeting (service_mapping.h): for several
  // heartbeats, since a busy computer delays them and Wi-Fi loses some. Then it is sent in any case. While a killed client does
  // not acknowledge, until its lease ends, it is unknown when a new one did.
  static constexpr std::chrono::milliseconds kLongestGreeting{500};

  // The node entry outlives the server.
  static Expected<std::unique_ptr<ServiceServer>> create(NodeEntry& node,
                                                         const ServiceName& service,
                                                         const rtps::Qos& qos, Handler handler);
  static Expected<std::unique_ptr<ServiceServer>> create_slow(NodeEntry& node,
                                                              const ServiceName& service,
                                                              const rtps::Qos& qos,
                                                              SlowHandler handler,
                                                              const ServiceHashes& hashes = {});
  ~ServiceServer();

 private:
  struct Request {
    rtps::Bytes payload;
    rtps::SampleIdentity identity;
    rtps::SampleIdentity related;
  };
  struct Reply {
    rtps::Bytes payload;
    rtps::SampleIdentity related;         // in the inline mapping
    std::optional<ServiceHeader> header;  // in the other one
    // The client's reply reader, as far as the client named it: its GUID, or the id in its user
    // data.
    std::variant<std::monostate, rtps::Guid, std::string> reader;
  };

  // A request, apart from how it came, and a reply to it without a payload.
  struct Call {
    rtps::Bytes request;
    Reply reply;
  };
  // The server as late answers see it.
  struct Late {
    Mutex mutex;
    ServiceServer* server CULPRIT_GUARDED_BY(mutex) = nullptr;  // null: it is gone
  };

  using AnyHandler = std::variant<Handler, SlowHandler>;

  ServiceServer(NodeEntry& node, AnyHandler handler, std::size_t depth);
  Expected<void> open(const ServiceName& service, const rtps::Qos& qos,
                      const ServiceHashes& hashes);
  static Expected<std::unique_ptr<ServiceServer>> create_any(NodeEntry& node,
                                                             const ServiceName& service,
                                                             const rtps::Qos& qos,
                                                             AnyHandler handler,
                                                             const ServiceHashes& hashes);

  // On the executor's thread.
  void handle_next();
  std::optional<Call> read_inline(const Request& request) const;
  std::optional<Call> read_header(const Request& request) const;
  Answer answer_to(Reply reply);
  void deliver(Reply reply);
  bool is_expected(const Reply& reply) const;
  bool has_greeted(const Reply& reply);
  void look_at_greeting();
  void send(const Reply& reply);
  void send_waiting();
  void on_match(const rtps::Guid& reader, Match match);

  NodeEntry& node_;
  const AnyHandler handler_;
  const std::shared_ptr<Late> late_;
  const std::size_t depth_;

  // Used by the executor's thread only.
  std::set<rtps::Guid> reply_readers_;
  bool has_fresh_reader_ = false;  // one that has matched since the last greeting
  // Set while a greeting is on its way.
  std::optional<Executor::Clock::time_point> greeting_ends_;
  std::map<std::uint64_t, Reply> waiting_;
  std::uint64_t next_waiting_ = 1;

  Mutex mutex_;
  std::deque<Request> requests_ CULPRIT_GUARDED_BY(mutex_);

  TaskGroup tasks_;  // outlives those that post to it
  std::unique_ptr<Writer> reply_writer_;
  std::unique_ptr<Reader> request_reader_;
};

}  // namespace culprit::ros2
