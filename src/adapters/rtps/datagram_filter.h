// Decides which datagrams a participant's middleware receives.
//
// Fast DDS trusts every datagram that claims to come from a known writer. After one GAP or
// HEARTBEAT with an absurd sequence number it counts up to that number with its locks held. It is
// then deaf for good and cannot even be ended. A fragment makes it reserve as much memory as the
// fragment claims for its sample. So each submessage is checked first. A submessage that no
// participant sends is replaced by padding, and a datagram that is no RTPS message is dropped.
// These are refused (RTPS 2.3 §8.3, §9.4):
//
//   structure         lengths that do not fit, lists that do not end, bitmaps of more than 256 bits.
//   sequence numbers  further ahead of the writer's last known number than it can have written
//                     since (writer_records.h); gaps no further ahead than heartbeats may be.
//   fragments         of samples that are larger than the budgets (writer_records.h), or that
//                     contradict earlier fragments of the same sample.
//
// The content of secured submessages is not checked here: their signatures prove them.
//
// The filter also saves Fast DDS work. Writers address their samples to all matched readers, and
// Fast DDS asks each reader of the participant whether it is meant. The filter knows which reader
// has matched which writer: a sample that one reader receives is addressed to that reader. If no
// reader is known to receive a writer, most of its samples are taken out. A few are passed on: if
// one is delivered all the same, its reader is known.
//
// A reader that only needs samples and their times gets them here, and the middleware never sees
// them: whole samples to one best effort reader, without inline parameters (OnWhole).
//
// The filter also withholds the announcements of others' readers and writers that no endpoint of
// this participant will ever match (discover()). The middleware would keep each of them, and
// compare it with each of its own endpoints: that is most of the cost of discovering a large robot.
// Fast DDS receives a GAP instead, and so acknowledges the announcement as any other. The end of an
// endpoint is reported to both.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
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
#include "rtps/submessage_reader.h"
#include "rtps/system_time.h"
#include "rtps/writer_records.h"

namespace culprit::rtps {

// All members may be called from any thread.
class DatagramFilter {
 public:
  using Clock = std::chrono::steady_clock;

  // Limits for a writer that is not known yet. A reliable reader counts through all earlier
  // numbers.
  static constexpr std::int64_t kFirst = std::int64_t{1} << 40;
  static constexpr std::int64_t kFirstReliable = std::int64_t{1} << 20;

  // Gives the part of `datagram` that may be passed on, after taking out and addressing
  // submessages; empty: none. `now` never goes back by much. `received`: when it came, which may be
  // a moment earlier.
  ByteView pass(std::span<std::uint8_t> datagram, Clock::time_point now, SystemTime received);

  // `reader`, of this participant, begins to receive the writer, or ends. For a writer without a
  // reader no state is kept or needed.
  using OnUnheard = std::shared_ptr<const std::function<void()>>;
  static constexpr int kUnheard = 3;
  // The number of samples in a second that are passed on from a writer without a known reader.
  static constexpr int kTries = 8;
  using Reading = WriterRecords::Reading;
  // A sample that came whole. `payload` is invalid when the callback returns.
  struct Whole {
    Guid writer;
    std::int64_t sequence = 0;
    SystemTime sent;      // by the writer's clock
    SystemTime received;  // by ours
    ByteView payload;     // with its encapsulation
  };
  using OnWhole = std::shared_ptr<const std::function<void(const Whole&)>>;
  // Best effort: `on_unheard` is called from pass(), without locks, for each further sample of
  // which a part arrived, once kUnheard others in a row were not delivered. It proves that the
  // writer is alive. `on_whole`, if set, is called in the same way for each newer sample that the
  // middleware would hand to this reader alone; the middleware does not get it. Samples in
  // fragments are delivered by the middleware.
  void begin_hearing(const Guid& writer, const Guid& reader, Reading how, OnUnheard on_unheard = {},
                     OnWhole on_whole = {});
  void end_hearing(const Guid& writer, const Guid& reader);
  // From now on it addresses; not before, for in a secured domain it is unclear which readers have
  // matched. While readers are being made or unmade, it is not clear either: then everything stays
  // as it is.
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
  // From now on `on_news`, from pass(), without locks, reports the endpoints of other participants
  // for which `never_meets` is true. It does so when they are announced, when their announcement
  // changes, and when they end, but not at the end of their participant. Endpoints beyond
  // kMostAnnounced go to the middleware, and so do announcements in fragments. Not in a secured
  // domain, where announcements cannot be seen.
  static constexpr std::size_t kMostAnnounced = 1 << 16;
  using NeverMeets = std::function<bool(std::string_view topic, EndpointRole role)>;
  void discover(const GuidPrefix& self, NeverMeets never_meets,
                std::function<void(const EndpointNews&)> on_news);
  // The participant is there: its discovery data count. Or it has left, and its memory is free
  // again.
  void know(const GuidPrefix& participant);
  void forget(const GuidPrefix& participant);
  bool knows(const GuidPrefix& participant) const;
  // The number of writers whose last sequence number it keeps.
  std::size_t known_writers() const;

  // Submessages and datagrams that were taken out so far, and why the last one was; empty: none.
  struct Refused {
    std::uint64_t count = 0;
    std::string why;
  };
  Refused refused() const;
  // A datagram was taken out before pass().
  void note_refused(const char* why);

 private:
  // The header data of a datagram for the submessages that follow.
  struct Course {
    GuidPrefix source;
    GuidPrefix destination;  // zero: all
    SystemTime received;
    std::optional<SystemTime> sent;
  };

  static void follow(std::span<std::uint8_t> submessage, ByteView body, Course& course);
  ByteView look_at(std::span<std::uint8_t> datagram, Clock::time_point now, SystemTime received)
      CULPRIT_REQUIRES(mutex_);
  bool address(std::span<std::uint8_t> submessage, const Course& course, Clock::time_point now)
      CULPRIT_REQUIRES(mutex_);
  // The newest gap in the present datagram.
  struct Gap {
    std::span<std::uint8_t> base;  // the number that follows it
    Guid writer;
    std::int64_t next = 0;
    bool is_little = true;
  };
  enum class Announcement : std::uint8_t { kOfMiddleware, kGap, kInGapBefore };
  Announcement take(std::span<std::uint8_t> submessage, const Course& course, Gap& last)
      CULPRIT_REQUIRES(mutex_);
  bool tell_of_announcement(const SubmessageReader& submessage) CULPRIT_REQUIRES(mutex_);
  bool tries(const Guid& stranger, Clock::time_point now) CULPRIT_REQUIRES(mutex_);
  const char* objection(const SubmessageReader& submessage, Clock::time_point now)
      CULPRIT_REQUIRES(mutex_);
  const char* objection_to_data(const SubmessageReader& submessage, Clock::time_point now)
      CULPRIT_REQUIRES(mutex_);
  const char* objection_to_fragment(const SubmessageReader& submessage, Clock::time_point now)
      CULPRIT_REQUIRES(mutex_);
  const char* objection_to_heartbeat(const SubmessageReader& submessage, Clock::time_point now)
      CULPRIT_REQUIRES(mutex_);
  const char* objection_to_gap(const SubmessageReader& submessage, Clock::time_point now)
      CULPRIT_REQUIRES(mutex_);

  // The readers of this participant that receive one writer.
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
  void came_by(const Guid& writer, std::int64_t sequence) CULPRIT_REQUIRES(mutex_);

  mutable Mutex mutex_;
  WriterRecords writers_ CULPRIT_GUARDED_BY(mutex_);  // of those with a reader here
  std::unordered_map<Guid, Readers> readers_
      CULPRIT_GUARDED_BY(mutex_);  // by the writer that they receive
  std::unordered_set<GuidPrefix> participants_ CULPRIT_GUARDED_BY(mutex_);  // that are there
  Refused refused_ CULPRIT_GUARDED_BY(mutex_);
  // Writers without a known reader: the samples that were passed on in this second.
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
  // The newest announcement of each endpoint, or of its end: older ones may come later.
  std::unordered_map<Guid, std::int64_t> announced_ CULPRIT_GUARDED_BY(mutex_);
  std::vector<EndpointNews> news_ CULPRIT_GUARDED_BY(mutex_);
};

}  // namespace culprit::rtps
