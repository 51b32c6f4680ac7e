// Calls a service of another node, without ever blocking.
//
// Speaks to servers on Fast DDS and on Cyclone DDS, each in its own mapping (service_mapping.h).
// The guarantees of DDS are not enough to call safely: "matched" here does not mean matched there,
// and a request or reply that is sent before the other side has matched is lost. Hence two kinds of
// request:
//
// - one that may run twice (a read) is sent again until it is answered: every 200 ms, or at twice
//   the time that the server's last answer took, at most 2 s. So a node that spins once a second is
//   asked once;
// - one that must not (a transition) is sent exactly once, and never before the server has proven
//   that it knows this client. Discovery data is ordered for each participant, so the proof is an
//   answer to a probe: a request that may be repeated, to another service of the same node, through
//   a client that was created later. Give a Probe to have it; the client then probes each new
//   server as soon as it sees one, so that a call need not wait for it.
//
// A killed server stays matched until its lease ends (20 s), next to its restarted successor:
// requests go to both, and the newest server, or the one that has proven to be alive, decides the
// mapping. A proof is good until another server comes, or the graph reports that one has left; so a
// caller that learns from the graph that a node is there can call it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/expected.h"
#include "base/mutex.h"
#include "base/units.h"
#include "ros2/context.h"
#include "ros2/executor.h"
#include "ros2/participant.h"
#include "ros2/service_mapping.h"
#include "ros2/soon_task.h"
#include "rtps/cdr.h"
#include "rtps/guid.h"

namespace culprit::ros2 {

struct ServiceName {
  std::string name;  // absolute: "/camera/change_state"
  std::string type;  // "lifecycle_msgs/srv/ChangeState"
};

enum class Repeat : std::uint8_t { kUntilAnswered, kNever };

enum class CallOutcome : std::uint8_t {
  kAnswered,
  kUnreachable,  // never sent: no server, or none that proved that it knows us
  kTimedOut      // sent, not answered; it may have been carried out
};

struct CallResult {
  CallOutcome outcome = CallOutcome::kUnreachable;
  rtps::ByteView reply;     // a payload with its encapsulation; gone when the callback returns
  rtps::GuidPrefix server;  // the participant that answered
};

// Thread-safe. The callback of a call comes once: an answer on a receive thread (participant.h
// lists what is not allowed there), its absence on the executor's thread. When the client is
// destroyed, calls under way are forgotten.
class ServiceClient {
 public:
  using Callback = std::function<void(const CallResult&)>;

  struct Probe {
    ServiceName service;
    rtps::Bytes request;
  };

  // The node entry outlives the client. kSoon: for a client that repeats its requests, and mostly
  // has time, as the client of a probe; its answers are not sent again by the server if they are
  // lost.
  static Expected<std::unique_ptr<ServiceClient>> create(
      NodeEntry& node, const ServiceName& service, const rtps::Qos& qos = rtps::qos::kServices,
      rtps::Haste haste = rtps::Haste::kNow);
  static Expected<std::unique_ptr<ServiceClient>> create(NodeEntry& node,
                                                         const ServiceName& service,
                                                         const rtps::Qos& qos, Probe probe);
  ~ServiceClient();

  // Sends in the calling thread if a server is ready, otherwise as soon as one is. `request` is a
  // whole payload. kSoon: the answer of a client that has time may come ReceiveThread::kSoon late, and so its absence.
  void call(rtps::Bytes request, Repeat repeat, Duration timeout, Callback callback,
            rtps::Haste haste = rtps::Haste::kNow);

  // A request with Repeat::kNever would be sent at once.
  bool is_ready() const;

  // The client of the probe, for reads of one's own. Null without one.
  ServiceClient* probe() { return probe_.get(); }

  // From now on only servers of this participant count, also for the probe: anybody may offer a service of the same name,
  // and receives what is asked of it. An answer of others is none, and a call goes on waiting.
  void ask_only(const rtps::GuidPrefix& participant);

 private:
  struct Server {
    rtps::GuidPrefix participant;
    Mapping mapping = Mapping::kInline;
  };
  struct Call {
    rtps::Bytes request;
    Repeat repeat = Repeat::kNever;
    Callback callback;
    std::unique_ptr<Participant::Hurry> hurry;  // unless it has time
    bool is_sent = false;
    TaskGroup::TimerId deadline;
    TaskGroup::TimerId next_send;
  };
  using CallNumber = std::uint64_t;
  using RequestId = std::pair<Mapping, std::int64_t>;  // of one sending of a call
  struct Sending {
    CallNumber call = 0;
    Executor::Clock::time_point at;
  };

  explicit ServiceClient(NodeEntry& node);
  Expected<void> open(const ServiceName& service, const rtps::Qos& qos, rtps::Haste haste);
  Expected<void> open_probe(Probe probe);

  // On a receive thread.
  void on_reply(const Sample& sample);
  // On the executor's thread.
  void on_request_reader(const rtps::Guid& reader, Match match);
  void on_reply_writer(const rtps::Guid& writer, Match match);
  void update_servers();
  void on_server_left();
  void send_waiting();
  void start_probe();
  void on_probe(std::uint64_t round, CallOutcome outcome, const rtps::GuidPrefix& participant);
  void on_send_again(CallNumber number);
  void on_deadline(CallNumber number);

  // With mutex_.
  const Server* server_for(Repeat repeat) const CULPRIT_REQUIRES(mutex_);
  void lose_proof() CULPRIT_REQUIRES(mutex_);
  void send(CallNumber number, Call& call) CULPRIT_REQUIRES(mutex_);
  std::optional<Call> take(CallNumber number) CULPRIT_REQUIRES(mutex_);

  NodeEntry& node_;
  // The ids by which replies name us. They are copies: a reply may come while reader and writer are
  // being destroyed.
  rtps::Guid reader_id_;
  rtps::Guid writer_id_;
  std::uint64_t header_id_ = 0;  // what Cyclone knows us by

  // Used by the executor's thread only: the matched endpoints, with the order in which they came.
  Matches request_readers_;
  Matches reply_writers_;
  std::uint64_t matches_ = 0;
  bool is_probing_ = false;

  mutable Mutex mutex_;
  std::vector<Server> servers_
      CULPRIT_GUARDED_BY(mutex_);  // both endpoints matched; the newest last
  std::optional<rtps::GuidPrefix> only_
      CULPRIT_GUARDED_BY(mutex_);                            // whose servers count; nothing: all
  std::optional<Server> proven_ CULPRIT_GUARDED_BY(mutex_);  // with a probe: the one that knows us
  std::uint64_t proof_round_ CULPRIT_GUARDED_BY(mutex_) =
      0;  // counts the times that a proof was lost
  std::map<CallNumber, Call> calls_ CULPRIT_GUARDED_BY(mutex_);
  std::map<RequestId, Sending> requests_ CULPRIT_GUARDED_BY(mutex_);
  CallNumber last_call_ CULPRIT_GUARDED_BY(mutex_) = 0;
  Duration again_after_ CULPRIT_GUARDED_BY(mutex_);
  std::int64_t header_sequence_ CULPRIT_GUARDED_BY(mutex_) = 0;

  TaskGroup tasks_;  // outlives those that post to it
  SoonTask update_servers_soon_;

  // Set once, with the mutex.
  std::unique_ptr<Reader> reply_reader_;
  std::unique_ptr<Writer> request_writer_;
  rtps::Bytes probe_request_;
  std::unique_ptr<ServiceClient> probe_;
};

}  // namespace culprit::ros2
