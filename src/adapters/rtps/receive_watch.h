// Whether the thread that receives is at work: whether a datagram lies unread in its sockets.
//
// What a participant says to itself (hearing.h) does not pass every socket: what comes by multicast
// goes away with a network interface, and nothing is wrong. So each socket is looked at: one whose
// first datagram is still the same is not read. Others would seem to be gone for no other reason than
// that: their announcements come there.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/mutex.h"
#include "base/time.h"

namespace culprit::ros2 {

// All members may be called from any thread.
class ReceiveWatch {
 public:
  // Looks at these UDP sockets, which are open until it returns, a microsecond each. Call it again
  // and again.
  void look(std::span<const int> sockets, Time now);
  // Until when each was known to be read. kNever: nobody looked yet.
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
  std::vector<Socket> sockets_ CULPRIT_GUARDED_BY(mutex_);
};

}  // namespace culprit::ros2
