// The last messages of a robot, in bounded memory: messages that are too old, or for which there is
// no room, go, the oldest first.
//
// Large messages have room of their own, so that one camera does not drive out everything else. The
// last message of each publisher of a latched topic (a map, static transforms) stays, however old.
//
// It is the only buffer between the receive threads and the writer, which takes the messages that
// it has not seen yet. If the writer is too slow, messages are lost and counted, and no receive
// thread waits.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <vector>

#include "base/mutex.h"
#include "base/time.h"
#include "rtps/cdr.h"
#include "rtps/guid.h"

namespace culprit::recorder {

struct RingMessage {
  std::uint64_t number = 0;    // in the order in which they came, from 1; the ring gives it
  std::size_t topic = 0;       // the caller's number for it
  std::uint32_t sequence = 0;  // of its publisher
  Time at{};                   // when it came, by the clock that never jumps
  std::int64_t received = 0;   // the same by the wall clock, nanoseconds since 1970
  std::int64_t sent = 0;       // by its publisher's clock
  rtps::Bytes payload;         // with its encapsulation
};
using SharedMessage = std::shared_ptr<const RingMessage>;

enum class Share : std::uint8_t { kSmall, kLarge };

// From any thread; a call waits at most for another thread's call.
class MessageRing {
 public:
  struct Limits {
    std::size_t small_bytes = 0;
    std::size_t large_bytes = 0;
    std::size_t latched_bytes = 0;  // of what stays
    Duration keep{};
  };
  // The memory of a message beside its payload, about.
  static constexpr std::size_t kOverhead = 256;  // bytes

  explicit MessageRing(Limits limits) : limits_(limits) {}

  void push(RingMessage message, Share share);
  // It stays until its publisher publishes another one. It is not given by after().
  void latch(RingMessage message, const rtps::Guid& publisher);

  // Those after `number` that came at `since` or later, in the order in which they came; so many bytes of them, and at least one if there
  // is one.
  std::vector<SharedMessage> after(std::uint64_t number, Time since, std::size_t most_bytes);
  // The latched messages that came before `since`.
  std::vector<SharedMessage> latched(Time since) const;

  // From now on it counts what came at `since` or later and goes before after() gave it; until stop_counting().
  void count_lost(Time since);
  std::uint64_t stop_counting();

  // The size of the held messages, with kOverhead for each; latched ones apart.
  std::size_t bytes(Share share) const;
  std::size_t latched_bytes() const;

 private:
  struct Part {
    std::deque<SharedMessage> messages;
    std::size_t bytes = 0;
  };
  static std::size_t size_of(const RingMessage& message) {
    return message.payload.size() + kOverhead;
  }
  void drop_front(Part& part) CULPRIT_REQUIRES(mutex_);

  const Limits limits_;
  mutable Mutex mutex_;
  std::array<Part, 2> parts_ CULPRIT_GUARDED_BY(mutex_);  // by Share
  std::map<std::pair<std::size_t, rtps::Guid>, SharedMessage> latched_ CULPRIT_GUARDED_BY(mutex_);
  std::size_t latched_bytes_ CULPRIT_GUARDED_BY(mutex_) = 0;
  std::uint64_t last_ CULPRIT_GUARDED_BY(mutex_) = 0;      // number given
  std::uint64_t taken_ CULPRIT_GUARDED_BY(mutex_) = 0;     // the highest that after() gave
  Time counts_since_ CULPRIT_GUARDED_BY(mutex_) = kNever;  // kNever: nothing is counted
  std::uint64_t lost_ CULPRIT_GUARDED_BY(mutex_) = 0;
};

}  // namespace culprit::recorder
