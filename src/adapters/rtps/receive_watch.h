// Checks that the receive thread works: whether a datagram lies unread in its sockets.
//
// A participant's messages to itself (hearing.h) do not pass every socket: multicast datagrams
// vanish with a network interface, and that is no fault. So each socket is checked: if its first
// datagram is still the same, it is not read. An unread socket would make other participants seem
// to have left: their announcements come there.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/mutex.h"
#include "base/time.h"

namespace culprit::rtps {

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

}  // namespace culprit::rtps
