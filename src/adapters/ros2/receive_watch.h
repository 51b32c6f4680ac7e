// Whether the threads that receive are at work: whether a datagram lies unread in their sockets.
//
// What a participant says to itself (hearing.h) does not pass every thread: what comes by multicast
// goes away with a network interface, and nothing is wrong. So each socket is looked at: one whose
// first datagram is still the same has a thread that hangs. Others would seem to be gone for no
// other reason than that: their announcements come there.
#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "base/mutex.h"
#include "base/time.h"

namespace culprit::ros2 {

// All members may be called from any thread.
class ReceiveWatch {
 public:
  // The middleware receives on this UDP port of this process, with whatever number of sockets.
  void opened(std::uint16_t port);

  // Looks at the sockets, some 50 microseconds long. Call it again and again.
  void look(Time now);
  // Until when each thread was known to be at work. kNever: nobody looked yet.
  Time attended() const;

 private:
  // When the first datagram that is unread came, by the clock of the machine.
  struct Arrival {
    std::int64_t seconds = 0;
    std::int64_t nanoseconds = 0;
    bool operator==(const Arrival&) const = default;
  };
  struct Socket {
    int descriptor;
    Arrival unread;  // 0: nothing
    Time attended;
  };
  static Arrival first_unread(int descriptor);

  mutable Mutex mutex_;
  std::set<std::uint16_t> ports_ CULPRIT_GUARDED_BY(mutex_);
  std::vector<Socket> sockets_ CULPRIT_GUARDED_BY(mutex_);
};

}  // namespace culprit::ros2
