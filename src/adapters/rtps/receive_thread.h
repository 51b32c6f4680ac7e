// One thread that receives from all UDP sockets of a participant.
//
// Fast DDS has a thread for each socket, and a system call for each datagram. Here one thread waits
// for all of them, and takes what lies in a socket together.
//
// A participant that discovers a robot receives all announcements at once, more than a socket's
// buffer holds. Each lost one is sent again by every peer, to everybody. So all datagrams in a
// socket are taken at once, and kept up to kMostKept until its turn comes: of each socket kBatch
// datagrams, then of the next one.
//
// Waking the thread costs most. So some sockets have time (Haste::kSoon): they are read whenever
// the thread is awake anyway. If so many datagrams come that this is cheaper, they are read every
// kSoon instead of with each datagram. They are read sooner if more come, for a socket's buffer is
// small. Their datagrams are always handed on before later ones of the other sockets: after a
// message there, a reader has received all earlier ones. The kernel gives the time of arrival of
// each datagram. A caller that waits for an answer there makes them hurry meanwhile
// (begin_hurry()).
//
// A socket that is not read fast enough is full, and the kernel drops what comes then. It tells how much with the next
// datagram there (SO_RXQ_OVFL), so a reader can distinguish that from what was lost on the way.
//
// A socket for announcements has time only while nothing else comes there (Place::has_time): in a
// robot at rest each participant repeats again and again that it is there.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <netinet/in.h>
#include <span>
#include <thread>
#include <vector>

#include "base/expected.h"
#include "base/mutex.h"
#include "base/wake_file.h"
#include "rtps/datagram_sources.h"
#include "rtps/haste.h"
#include "rtps/system_time.h"

namespace culprit::rtps {

// All members may be called from any thread but the one that receives.
class ReceiveThread {
 public:
  static constexpr std::size_t kBatch = 4;
  static constexpr std::size_t kMostKept = 4 << 20;  // bytes, of each socket
  static constexpr std::uint32_t kLargest = 65'536;  // bytes; UDP carries less
  static constexpr std::chrono::milliseconds kSoon{100};
  static constexpr std::chrono::milliseconds kSoonest{4};
  static constexpr const char* kName = "culprit-receive";  // of the thread, as `top -H` shows it

  struct Datagram {
    std::span<std::uint8_t> bytes;
    UdpAddress from;
    SystemTime received;
  };
  // Called on the thread that receives, one at a time. It may write into the datagram, whose memory
  // is invalid when it returns.
  using OnDatagram = std::function<void(const Datagram&)>;
  using HasTime = std::function<bool(std::span<const std::uint8_t> datagram)>;
  // For so long, announcements must have come and nothing else.
  static constexpr std::chrono::seconds kCalm{2};

  ReceiveThread();
  ~ReceiveThread();
  ReceiveThread(const ReceiveThread&) = delete;
  ReceiveThread& operator=(const ReceiveThread&) = delete;

  struct Place {
    in_addr ip{};
    std::uint16_t port = 0;
    bool is_shared = false;    // with other sockets of this machine, as ports for multicast are
    std::uint32_t buffer = 0;  // bytes, which net.core.rmem_max caps; 0: the system's
    std::uint32_t largest = kLargest;  // bytes of a datagram; what is longer is cut
    Haste haste = Haste::kNow;
    HasTime has_time{};  // empty: always as `haste` sets
  };
  // Errors: the place is taken, or the system refuses. The thread begins with the first socket.
  Expected<void> open(const Place& place, OnDatagram on_datagram);
  // The sockets at the port are closed when it returns, and none of their callbacks runs.
  void close(std::uint16_t port);
  bool is_open(std::uint16_t port) const;

  // Datagrams to the group by way of the interface with this address come to the sockets at the
  // port, too. Once is enough; refusals are ignored: interfaces come and go.
  void join(std::uint16_t port, in_addr group, in_addr interface);

  // Until each that began has ended, datagrams to sockets that have time wake the thread, too.
  void begin_hurry();
  void end_hurry();

  // Calls `on_round`, on the thread that receives, whenever it has handed on what came together.
  void on_round(std::function<void()> on_round);

  // Datagrams that the kernel dropped because a socket was full: of each socket, those before the datagram that was handed
  // on last.
  std::uint64_t dropped() const { return dropped_; }

  // Calls `look` with all sockets, which stay open meanwhile. It must be short.
  void look_at_sockets(const std::function<void(std::span<const int> descriptors)>& look) const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Socket;
  using Sockets = std::vector<std::shared_ptr<Socket>>;
  class Batch;

  void run();
  // Hands on the datagrams of a socket without time, at most kBatch, and keeps the rest. Before
  // that, all that came to the patient ones.
  void take_urgent(Socket& socket, Batch& batch, const Sockets& patient, Batch& patient_batch);
  void take_patient(const Sockets& patient, Batch& batch);
  // Whether they wake the thread, and how often it looks otherwise, depends on how much comes to them.
  void watch_patient(Clock::time_point now) CULPRIT_REQUIRES(mutex_);
  void arm(bool is_armed) CULPRIT_REQUIRES(mutex_);
  void wake_for(const Socket& socket) CULPRIT_REQUIRES(mutex_);
  // Updates which of the sockets that have time only in calm have it now.
  void calm(Clock::time_point now) CULPRIT_REQUIRES(mutex_);

  const int wait_fd_;  // of epoll
  const WakeFile end_;

  std::atomic<std::uint64_t> dropped_ = 0;
  mutable Mutex mutex_;
  ConditionVariable round_ended_;
  Sockets sockets_ CULPRIT_GUARDED_BY(mutex_);
  std::shared_ptr<const std::function<void()>> on_round_ CULPRIT_GUARDED_BY(mutex_);  // or nothing
  std::uint64_t rounds_ CULPRIT_GUARDED_BY(mutex_) = 0;  // odd: one is under way
  bool is_armed_ CULPRIT_GUARDED_BY(mutex_) = true;      // patient sockets wake the thread
  int hurried_ CULPRIT_GUARDED_BY(mutex_) = 0;           // how many wait for an answer
  // Used by the thread only: how it looks at patient sockets, and what came to them since
  // `watched_`.
  std::chrono::milliseconds next_look_ = kSoonest;
  std::chrono::milliseconds often_ = kSoonest;
  Clock::time_point watched_{};
  std::size_t came_ = 0;    // datagrams
  double share_taken_ = 0;  // of its room by the one with most at each look; their sum
  std::thread thread_;      // begun under the mutex, joined without it
};

}  // namespace culprit::rtps
