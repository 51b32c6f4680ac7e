// Tests our own reception: a message that we send to ourselves, through sockets like all messages
// of the robot, and when it came back last.
//
// It is sent on the executor's thread and received on the receive thread, so that it also tests
// these threads, and the network interfaces. Discovery has a port of its own: the participant's own
// announcements must arrive there. Multicast datagrams are no test, since they vanish with a
// network interface. Instead each socket is checked for unread datagrams (receive_watch.h). Samples
// to readers that have time arrive before it if they were sent before it (receive_thread.h).
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>

#include "base/expected.h"
#include "base/time.h"
#include "ros2/participant.h"
#include "ros2/timer.h"

namespace culprit::ros2 {

class Hearing {
 public:
  static constexpr const char* kTopic = "rt/_culprit_hearing";
  static constexpr const char* kType = "culprit::msg::dds_::Heartbeat_";
  static constexpr Duration kPeriod = std::chrono::milliseconds(100);
  // A participant that has not received its own message for so long does not receive others either.
  // Shorter than the usual topic timeouts of rules.
  static constexpr Duration kPatience = std::chrono::milliseconds(400);
  // The first time, since the endpoints have to find each other.
  static constexpr Duration kFirstPatience = std::chrono::seconds(3);

  // Both outlive it. An error when the middleware, or the domain's permissions, refuse.
  static Expected<std::unique_ptr<Hearing>> begin(Participant& participant, Executor& executor);

  // Our announcements to everybody arrive at our own discovery port too, once a second.
  static constexpr Duration kDiscoveryPatience = std::chrono::seconds(5);

  // A datagram that lies unread for so long has no thread that reads it. Looked at again and again.
  static constexpr Duration kReceivePatience = std::chrono::seconds(2);
  static constexpr Duration kLookPeriod = std::chrono::milliseconds(500);

  // When it came back last. From any thread.
  Time heard() const { return Time(Duration(heard_->load())); }
  // Until when it has to come back again, by each way.
  Time doubtful() const {
    return std::min({later(heard(), kPatience),
                     later(participant_.own_came_through(), kDiscoveryPatience),
                     later(participant_.receivers_attended(), kReceivePatience)});
  }

  // Sends it now, without waiting for its next time. Messages that were sent to us before arrive
  // before it. From any thread.
  void say();

  // The test that did not come back in time, if reception is doubtful.
  const char* doubt(Time now) const;

 private:
  explicit Hearing(Participant& participant) : participant_(participant) {}

  Participant& participant_;
  // Shared with the reader's callback, which runs before there is a Hearing.
  std::shared_ptr<std::atomic<std::int64_t>> heard_;
  std::uint64_t secret_ = 0;  // no other participant sends it
  std::unique_ptr<Reader> reader_;
  std::unique_ptr<Writer> writer_;
  std::unique_ptr<Timer> timer_;
  std::unique_ptr<Timer> look_;
};

}  // namespace culprit::ros2
