// The messages to browsers, and how they catch up: between the manager's thread, which never waits,
// and the threads of the web server, which may.
//
// Two kinds of messages. For a *latest* one (the graph, the present state) only the newest counts:
// a slow reader skips those between. *Events* are a history: a reader gets each of them, as long as
// it is kept. All are numbered in one sequence. So a reader that gives its last number goes on from
// there, and a new one begins at 0.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/mutex.h"

namespace culprit::http {

// kLearned may be large, and is only for latest(): no stream has it.
enum class Kind : std::uint8_t { kRobot, kGraph, kState, kControl, kLearned, kEvent };
inline constexpr std::size_t kKinds = 6;
// "robot", "graph", "state", "control", "learned", "event": as the stream names them.
std::string_view to_string(Kind kind);

struct Message {
  std::uint64_t number = 0;
  Kind kind = Kind::kEvent;
  std::shared_ptr<const std::string> data;  // JSON, on one line
};

// All members may be called from any thread. None of them waits for a reader.
class Hub {
 public:
  // Older events are forgotten beyond this many, or beyond this many bytes.
  static constexpr std::size_t kMostEvents = 4096;
  static constexpr std::size_t kMostBytes = 16 << 20;
  // A batch holds at most so many messages: a reader must have sent it before the next.
  static constexpr std::size_t kBatch = 256;

  // `wake` is called when a reader comes while there was none: a caller that publishes only for
  // readers can do so at once. It must not block.
  explicit Hub(std::function<void()> wake = {});

  void publish(Kind kind, std::string data);
  // Asks the publisher to publish, as if a reader had come.
  void wake() const {
    if (wake_) wake_();
  }

  struct Batch {
    bool is_gap = false;  // events between `after` and the first of these are forgotten
    std::vector<Message> messages;
  };
  // The messages after number `after`, oldest first: at once if there are any, else as soon as
  // there are. Empty if nothing came in `patience`, or the hub was closed.
  Batch wait(std::uint64_t after, std::chrono::milliseconds patience);
  // The newest message of a kind that is not kEvent; null if there was none.
  std::shared_ptr<const std::string> latest(Kind kind) const;

  // Somebody reads as long as one of these lives.
  class Reader {
   public:
    explicit Reader(Hub& hub);
    ~Reader() { --hub_.readers_; }
    Reader(const Reader&) = delete;

   private:
    Hub& hub_;
  };
  bool has_readers() const { return readers_ > 0; }

  // The name of this hub and no other: after a restart, a number alone means nothing.
  const std::string& name() const { return name_; }
  // The number of the newest message.
  std::uint64_t last() const;

  // No reader waits from now on.
  void close();
  bool is_closed() const { return is_closed_; }

 private:
  Batch collect(std::uint64_t after) const CULPRIT_REQUIRES(mutex_);

  const std::string name_;
  const std::function<void()> wake_;
  std::atomic<int> readers_ = 0;
  std::atomic<bool> is_closed_ = false;

  mutable Mutex mutex_;
  ConditionVariable something_came_;
  std::uint64_t last_ CULPRIT_GUARDED_BY(mutex_) = 0;
  std::array<Message, kKinds> latest_ CULPRIT_GUARDED_BY(mutex_);  // number 0: none yet
  std::deque<Message> events_ CULPRIT_GUARDED_BY(mutex_);
  std::size_t bytes_ CULPRIT_GUARDED_BY(mutex_) = 0;
  std::uint64_t forgotten_ CULPRIT_GUARDED_BY(mutex_) =
      0;  // number of the newest event that is kept no more
};

}  // namespace culprit::http
