// Offers a service to clients on Fast DDS and on Cyclone DDS at once (service_mapping.h).
//
// A request is handled on the executor's thread. A reply that is sent before the client's reply
// reader has matched would be lost, so it waits for that, up to 5 s and without holding anything
// up. Both rmw implementations wait 100 ms, for they do hold up what comes next; on a busy machine
// that loses replies.
#pragma once

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
#include "ros2/cdr.h"
#include "ros2/context.h"
#include "ros2/executor.h"
#include "ros2/participant.h"
#include "ros2/service_client.h"
#include "ros2/service_mapping.h"

namespace culprit::ros2 {

class ServiceServer {
 public:
  // Request payload to reply payload, both with their encapsulation. An empty reply is none: the
  // request was malformed.
  using Handler = std::function<Bytes(ByteView request)>;

  // The node entry outlives the server.
  static Expected<std::unique_ptr<ServiceServer>> create(NodeEntry& node,
                                                         const ServiceName& service, const Qos& qos,
                                                         Handler handler);
  ~ServiceServer();

 private:
  struct Request {
    Bytes payload;
    SampleIdentity identity;
    SampleIdentity related;
  };
  struct Reply {
    Bytes payload;
    SampleIdentity related;               // in the inline mapping
    std::optional<ServiceHeader> header;  // in the other one
    // Who it is for, as far as the client said: its reader's GUID, or the id in that reader's user
    // data.
    std::variant<std::monostate, Guid, std::string> reader;
  };

  ServiceServer(NodeEntry& node, Handler handler, std::size_t depth);
  Expected<void> open(const ServiceName& service, const Qos& qos);

  // On the executor's thread.
  void handle_next();
  Reply answer_inline(const Request& request) const;
  Reply answer_header(const Request& request) const;
  bool is_expected(const Reply& reply) const;
  bool has_greeted(const Reply& reply);
  void look_at_greeting();
  void send(const Reply& reply);
  void send_waiting();
  void on_match(const Guid& reader, Match match);

  NodeEntry& node_;
  const Handler handler_;
  const std::size_t depth_;

  // Of the executor's thread.
  std::set<Guid> reply_readers_;
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
