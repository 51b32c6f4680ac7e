// Helps our requests for announcements that their writer passes over.
//
// A participant that was lost and comes back has to announce its endpoints to us again. We acknowledged these before it
// was lost, and it may not have noticed that: it was stopped, or its computer slept. Fast DDS sends them once more if our
// first acknowledgement has the number 0. If its heartbeat is faster than that, ours asks for the missing ones. Then it
// takes them for acknowledged, and sends another heartbeat instead (2.9, ReaderProxy::acked_changes_set()). Both repeat
// themselves for good, and its nodes are never seen.
//
// So a request that is repeated kTimes without progress goes out with the number 0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>

#include "base/mutex.h"
#include "rtps/cdr.h"
#include "rtps/guid.h"

namespace culprit::rtps {

// All members may be called from any thread.
class StuckRequests {
 public:
  static constexpr int kTimes = 4;
  static constexpr std::size_t kMostWriters = 4096;

  // From now on. Not in a secured domain, where datagrams are signed.
  void begin();

  // A datagram that we are about to send, as it is to be sent; empty: as it is.
  Bytes mended(ByteView datagram);

 private:
  struct Request {
    std::uint64_t first = 0;  // number that is missing
    int times = 0;
  };
  bool is_stuck(const Guid& writer, std::uint64_t first) CULPRIT_REQUIRES(mutex_);

  Mutex mutex_;
  bool has_begun_ CULPRIT_GUARDED_BY(mutex_) = false;
  std::unordered_map<Guid, Request> requests_ CULPRIT_GUARDED_BY(mutex_);  // by writer
};

}  // namespace culprit::rtps
