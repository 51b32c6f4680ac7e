// Limits how fast one source introduces participants.
//
// A participant that is not known yet costs the middleware milliseconds on the thread that receives everything: a thousand
// of them, which one stranger makes up in a moment, make it deaf for many seconds. A participant of a robot has a socket
// of its own and introduces itself. It does so again after a few seconds, so one that is refused is late and not lost.
//
// A stranger may have thousands of sockets, so another computer has a limit, too: above that of a robot's computer with
// hundreds of processes. On this one, the sockets of other users cannot be told from the robot's by their address.
//
// Pure: each question brings the time. All members may be called from any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <unordered_map>

#include "base/mutex.h"
#include "base/time.h"
#include "rtps/datagram_sources.h"
#include "rtps/guid.h"

namespace culprit::rtps {

class Newcomers {
 public:
  static constexpr int kAtOnce = 16;  // of a socket that introduced none for long
  static constexpr Duration kEach = std::chrono::milliseconds(250);
  static constexpr int kAtOnceOfComputer = 256;
  static constexpr Duration kEachOfComputer = std::chrono::milliseconds(31);
  // Beyond it each further source may introduce participants: a stranger keeps no other out.
  static constexpr std::size_t kMostSources = 4096;

  // Our own participant is no newcomer: that its announcements come back shows that we can receive.
  void begin(const GuidPrefix& self);
  bool is_self(const GuidPrefix& participant) const;

  // May a socket introduce one more?
  bool admits(const UdpAddress& from, Time now);

 private:
  struct Hash {
    std::size_t operator()(const UdpAddress& address) const;
  };
  // Sources of one kind, and what each introduced.
  class Sources {
   public:
    Sources(int at_once, Duration each) : at_once_(at_once), each_(each) {}
    // When all that the source introduced has been worked off, at one each `each`. Null: it is not counted.
    Time* find(const UdpAddress& source, Time now);
    bool has_room(const Time* until, Time now) const;
    void note(Time* until, Time now) const;

   private:
    const int at_once_;
    const Duration each_;
    std::unordered_map<UdpAddress, Time, Hash> until_;
    Time cleared_ = kLongAgo;  // of those that have been worked off
  };

  mutable Mutex mutex_;
  std::optional<GuidPrefix> self_ CULPRIT_GUARDED_BY(mutex_);
  Sources sockets_ CULPRIT_GUARDED_BY(mutex_){kAtOnce, kEach};
  Sources computers_ CULPRIT_GUARDED_BY(mutex_){kAtOnceOfComputer, kEachOfComputer};  // port 0
};

}  // namespace culprit::rtps
