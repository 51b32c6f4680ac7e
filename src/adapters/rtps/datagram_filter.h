// What a participant's middleware gets to see of the datagrams that come.
//
// Fast DDS trusts what claims to come from a known writer. One GAP or HEARTBEAT with an absurd
// sequence number has it count up to that number with its locks held, so that it is deaf for good
// and cannot even be ended; a fragment makes it reserve as much memory as the fragment says that
// its sample has. So each submessage is looked at first. One that no participant sends is replaced
// by padding, and a datagram that is no RTPS message is dropped. What is refused is (RTPS 2.3 §8.3,
// §9.4):
//
//   structure         lengths that do not fit, lists that do not end, bitmaps of more than 256 bits
//   sequence numbers  further ahead of what the writer was known to have written than it can have
//                     written since: kAhead, and kPerSecond for each second that it was not heard;
//                     gaps no further ahead than heartbeats may be
//   fragments         of samples that are larger than the budgets below, or that contradict what
//                     was said of the same sample before
//
// What secured submessages contain cannot be seen here; they are proven by their signatures.
//
// And it saves Fast DDS work. Writers address what they say to all readers that hear them, and Fast
// DDS asks each reader of the participant whether that is it. Here it is known who hears whom: what one
// reader hears is addressed to that reader. Of a writer that no reader is known to hear most is taken
// out; a little is passed on, for what is delivered all the same shows who hears it.
//
// Who only wants to know what is said, and when, is handed it here and the middleware never sees it:
// whole samples to one best effort reader, without inline parameters (OnWhole).
//
// Likewise readers and writers of others that no endpoint of this participant will ever meet
// (discover()). The middleware would keep all that each of them announced, and compare it with each endpoint of its
// own: that is most of what it costs to discover a large robot. It is told instead that there is a gap, and so
// acknowledges the announcement as any other. What ends is told to both.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "base/mutex.h"
#include "rtps/cdr.h"
#include "rtps/endpoint_info.h"
#include "rtps/guid.h"
#include "rtps/system_time.h"

namespace culprit::ros2 {

// All members may be called from any thread.
class DatagramFilter {
 public:
  using Clock = std::chrono::steady_clock;

  static constexpr std::int64_t kAhead = 256;
  static constexpr std::int64_t kPerSecond = 10'000;
  // Of a writer of which nothing is known. A reliable reader counts through what came before.
  static constexpr std::int64_t kFirst = std::int64_t{1} << 40;
  static constexpr std::int64_t kFirstReliable = std::int64_t{1} << 20;

  // Bytes of samples that come in fragments. What reliable readers keep until it is complete, of
  // one writer and of all; the largest samples of best effort writers, of one and of all.
  static constexpr std::size_t kReliableOfOne = 4u << 20;
  static constexpr std::size_t kReliableOfAll = 8u << 20;
  static constexpr std::size_t kLargest = 32u << 20;
  static constexpr std::size_t kLargestOfAll = 32u << 20;

  // What may be passed on of `datagram`, in which it takes out or addresses what has to be; empty if
  // nothing may. `now` never goes back by much. `received`: when it came, which may be a moment earlier.
  ByteView pass(std::span<std::uint8_t> datagram, Clock::time_point now, SystemTime received);

  // `reader`, of this participant, begins to hear the writer, or ends. Of a writer that no reader
  // hears nothing is known, and nothing has to be.
  using OnUnheard = std::shared_ptr<const std::function<void()>>;
  static constexpr int kUnheard = 3;
  // So much is passed on in a second of a writer that no reader is known to hear.
  static constexpr int kTries = 8;
  enum class Reading : std::uint8_t { kBestEffort, kReliable };
  // A sample that came whole. `payload` is gone when the callback returns.
  struct Whole {
    Guid writer;
    std::int64_t sequence = 0;
    SystemTime sent;      // by the writer's clock
    SystemTime received;  // by ours
    ByteView payload;     // with its encapsulation
  };
  using OnWhole = std::shared_ptr<const std::function<void(const Whole&)>>;
  // Best effort: `on_unheard` is called from pass(), without locks, for each further sample of
  // which something came by after kUnheard others of which none was delivered. So the writer lives.
  // Likewise `on_whole`, if there is one, for each newer sample that the middleware would hand to this
  // reader alone, and does not get; what it does get, as fragments, it delivers itself.
  void begin_hearing(const Guid& writer, const Guid& reader, Reading how, OnUnheard on_unheard = {},
                     OnWhole on_whole = {});
  void end_hearing(const Guid& writer, const Guid& reader);
  // From now on it addresses; not before, for in a secured domain it is not clear who hears whom. While
  // readers are being made or unmade, it is not clear either: then everything stays as it is.
  void begin_to_address();
  class Change {
   public:
    explicit Change(DatagramFilter& filter) : filter_(filter) { ++filter_.changes_; }
    ~Change() { --filter_.changes_; }
    Change(const Change&) = delete;

   private:
    DatagramFilter& filter_;
  };
  // A sample of the writer reached its reader.
  void delivered(const Guid& writer);
  // From now on `on_news`, from pass(), without locks, tells of the endpoints of other participants that
  // `never_meets` is true of: once when they are announced, again when they announce something else, and of their end,
  // but not of the end of their participant. Of more than kMostAnnounced the middleware hears as of all others, and
  // so of what comes in fragments. Not in a secured domain, where announcements cannot be seen.
  static constexpr std::size_t kMostAnnounced = 1 << 16;
  using NeverMeets = std::function<bool(std::string_view topic, EndpointRole role)>;
  void discover(const GuidPrefix& self, NeverMeets never_meets,
                std::function<void(const EndpointNews&)> on_news);
  // The participant is there: its discovery is heard. Or it is gone, and what it took is free
  // again.
  void know(const GuidPrefix& participant);
  void forget(const GuidPrefix& participant);

  // Submessages and datagrams that were taken out so far, and why the last one was; empty: none.
  struct Refused {
    std::uint64_t count = 0;
    std::string why;
  };
  Refused refused() const;

 private:
  struct Assembly {
    std::size_t size = 0;
    std::uint16_t fragment_size = 0;
    std::vector<bool> seen;  // by fragment; of reliable writers only
    std::size_t missing = 0;
  };
  struct Writer {
    std::int64_t last = 0;  // written, as far as is known
    Clock::time_point heard;
    std::map<std::int64_t, Assembly> assemblies;  // by sequence number; of best effort writers one
    std::size_t reserved = 0;                     // bytes
  };
  class Submessage;
  // What a datagram says of the submessages that follow.
  struct Course {
    GuidPrefix source;
    GuidPrefix destination;  // zero: all
    SystemTime received;
    std::optional<SystemTime> sent;
  };

  ByteView look_at(std::span<std::uint8_t> datagram, Clock::time_point now, SystemTime received)
      CULPRIT_REQUIRES(mutex_);
  bool address(std::span<std::uint8_t> submessage, const Course& course, Clock::time_point now)
      CULPRIT_REQUIRES(mutex_);
  // What was made a gap last, in the datagram that is looked at.
  struct Gap {
    std::span<std::uint8_t> base;  // the number that follows it
    Guid writer;
    std::int64_t next = 0;
    bool is_little = true;
  };
  enum class Announcement : std::uint8_t { kOfMiddleware, kGap, kInGapBefore };
  Announcement take(std::span<std::uint8_t> submessage, const Course& course, Gap& last)
      CULPRIT_REQUIRES(mutex_);
  bool tell_of_announcement(const Submessage& submessage) CULPRIT_REQUIRES(mutex_);
  bool tries(const Guid& stranger, Clock::time_point now) CULPRIT_REQUIRES(mutex_);
  const char* objection(const Submessage& submessage, Clock::time_point now)
      CULPRIT_REQUIRES(mutex_);
  const char* objection_to_data(const Submessage& submessage, Clock::time_point now)
      CULPRIT_REQUIRES(mutex_);
  const char* objection_to_fragment(const Submessage& submessage, Clock::time_point now)
      CULPRIT_REQUIRES(mutex_);
  const char* objection_to_heartbeat(const Submessage& submessage, Clock::time_point now)
      CULPRIT_REQUIRES(mutex_);
  const char* objection_to_gap(const Submessage& submessage, Clock::time_point now)
      CULPRIT_REQUIRES(mutex_);
  const char* reserve(const Guid& guid, std::int64_t sequence, const Assembly& wanted,
                      std::uint32_t first, std::uint32_t count) CULPRIT_REQUIRES(mutex_);

  // Of this participant, which hear one writer.
  struct Readers {
    struct Reader {
      Guid guid;
      Reading how;
      OnWhole on_whole{};
      std::int64_t last = 0;  // that was handed to it
    };
    std::vector<Reader> all{};
    bool is_reliable() const {
      return std::ranges::any_of(all, [](const Reader& r) { return r.how == Reading::kReliable; });
    }
    OnUnheard on_unheard{};
    std::int64_t sample = 0;  // of which something came by last
    int unheard = 0;          // so many in a row were not delivered
  };
  bool hand_over(Readers::Reader& reader, std::span<const std::uint8_t> submessage,
                 const Course& course) CULPRIT_REQUIRES(mutex_);
  bool is_heard(const Guid& writer) const CULPRIT_REQUIRES(mutex_);
  bool is_reliable(const Guid& writer) const CULPRIT_REQUIRES(mutex_);
  bool is_far(const Guid& writer, std::int64_t sequence, Clock::time_point now) const
      CULPRIT_REQUIRES(mutex_);
  void learn(const Guid& writer, std::int64_t sequence, Clock::time_point now)
      CULPRIT_REQUIRES(mutex_);
  void drop(const Guid& writer) CULPRIT_REQUIRES(mutex_);
  void came_by(const Guid& writer, std::int64_t sequence) CULPRIT_REQUIRES(mutex_);
  void release(const Guid& guid, Writer& writer, std::map<std::int64_t, Assembly>::iterator which)
      CULPRIT_REQUIRES(mutex_);
  std::size_t& total(const Guid& writer) CULPRIT_REQUIRES(mutex_);

  mutable Mutex mutex_;
  std::unordered_map<Guid, Writer> writers_ CULPRIT_GUARDED_BY(mutex_);  // that are heard
  std::unordered_map<Guid, Readers> readers_
      CULPRIT_GUARDED_BY(mutex_);  // by writer that they hear
  std::unordered_set<GuidPrefix> participants_ CULPRIT_GUARDED_BY(mutex_);  // that are there
  std::size_t reserved_reliable_ CULPRIT_GUARDED_BY(mutex_) = 0;
  std::size_t reserved_best_effort_ CULPRIT_GUARDED_BY(mutex_) = 0;
  Refused refused_ CULPRIT_GUARDED_BY(mutex_);
  // Writers that no reader is known to hear: what was passed on of them in this second.
  struct Stranger {
    Clock::time_point since;
    int tries = 0;
  };
  std::unordered_map<Guid, Stranger> strangers_ CULPRIT_GUARDED_BY(mutex_);
  bool addresses_ CULPRIT_GUARDED_BY(mutex_) = false;
  std::atomic<int> changes_ = 0;  // that are under way
  // To be called when this datagram was looked at.
  std::vector<OnUnheard> unheard_ CULPRIT_GUARDED_BY(mutex_);
  struct Handed {
    OnWhole to;
    Whole sample;
  };
  std::vector<Handed> handed_ CULPRIT_GUARDED_BY(mutex_);
  struct Discovery {
    GuidPrefix self;
    NeverMeets never_meets;
    std::function<void(const EndpointNews&)> on_news;
  };
  std::shared_ptr<const Discovery> discovery_ CULPRIT_GUARDED_BY(mutex_);  // null: not here
  // In which announcement each endpoint was told of last, or its end: older ones may come later.
  std::unordered_map<Guid, std::int64_t> announced_ CULPRIT_GUARDED_BY(mutex_);
  std::vector<EndpointNews> news_ CULPRIT_GUARDED_BY(mutex_);
};

}  // namespace culprit::ros2
