// A participant: it discovers the others, reads and writes payloads as bytes, and knows nothing of
// ROS but its quality of service. context.h makes a ROS 2 participant of it. It speaks DDS, or
// through a helper program the middleware of the robot (helper_participant.h), which then looks
// like DDS from here.
//
// Threads. Callbacks run on the thread that receives and on one of the middleware's, with its locks
// held. Each reader, writer or participant gets one at a time. They copy what they need and leave:
// they must not create or destroy readers and writers, write, or wait. Everything else here may be
// called from any thread. Destroying a reader, writer or participant waits for its running
// callback; so do not do it while holding a mutex which that callback takes, nor from the callback.
//
// Transport is UDP. Shared memory is off: segments of different Fast DDS versions are incompatible,
// and meeting an older one there can abort the process; UDP costs a few microseconds more.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/expected.h"
#include "ros2/options.h"
#include "rtps/cdr.h"
#include "rtps/datagram_filter.h"
#include "rtps/datagram_sources.h"
#include "rtps/endpoint_info.h"
#include "rtps/guid.h"
#include "rtps/haste.h"
#include "rtps/qos.h"
#include "rtps/system_time.h"

namespace culprit::rtps {
class Origins;
}  // namespace culprit::rtps

namespace culprit::ros2 {

// By the vendor id that the participant announces (RTPS 2.3 §9.3.1.3).
enum class Vendor : std::uint8_t { kFastDds, kCyclone, kOther };

// The announcement of a remote participant. Strings are as sent, cut at 1024 bytes.
struct ParticipantInfo {
  rtps::Guid guid;
  Vendor vendor = Vendor::kOther;
  std::string host{};  // its machine; empty if not announced
  int pid = 0;         // its process, by its own PID namespace; 0 if not announced
  std::vector<rtps::UdpAddress> metatraffic{};  // where it listens for discovery
  bool shares_memory = false;                   // it listens in shared memory, too (Fast DDS)
  bool is_secured = false;                      // it has an identity, signed by somebody
  // The full names of its nodes, if they are known with its announcement (helper_graph.h); over DDS they are not.
  std::vector<std::string> nodes{};
  // Not its word: where its datagrams came from. Filled in when its process is looked for.
  rtps::DatagramSources::Origin origin{};
  bool operator==(const ParticipantInfo&) const = default;
};

struct ParticipantGone {
  rtps::Guid guid;
  bool was_lost = false;  // without a goodbye: its lease ran out
};

// Also sent again when what is known changes, and only then.
using DiscoveryEvent =
    std::variant<ParticipantInfo, rtps::EndpointInfo, ParticipantGone, rtps::EndpointGone>;
using DiscoveryCallback = std::function<void(DiscoveryEvent)>;

// A sample as it came. `payload` is invalid when the callback returns.
struct Sample {
  // With its encapsulation; empty for a reader of headers, cut for one of beginnings.
  rtps::ByteView payload;
  std::size_t size = 0;   // of the payload, in bytes, also where it was not copied
  rtps::SystemTime sent;  // by the writer's clock
  rtps::SystemTime received;
  // Differences of its sequence number count what was written, whatever was lost.
  rtps::SampleIdentity identity;
  // The request that a reply answers, or the place where the reply to a request goes.
  rtps::SampleIdentity related;
};
using SampleCallback = std::function<void(const Sample&)>;

enum class Match : std::uint8_t { kMade, kLost };
using MatchCallback = std::function<void(const rtps::Guid& remote, Match)>;

// kHeader: for topics whose rate matters and whose size hurts; no payload is copied. A reader that
// does not read payloads has time: samples may come by ReceiveThread::kSoon late. Waking a thread
// for each sample would be most of the cost of a topic. They come before any sample that was sent
// later to another reader. kBeginning: of each payload only so much that a std_msgs/Header at its
// beginning is whole, unless its frame has an absurd name. kBeginningLater, kWholeLater: as much as
// without "Later", and samples may come as late as those of kHeader. Not for large samples: samples
// that arrive meanwhile must fit into the socket's buffer, or they are lost.
enum class PayloadUse : std::uint8_t {
  kWhole,
  kWholeLater,
  kHeader,
  kBeginning,
  kBeginningLater,
};
// Whether samples may come late.
constexpr bool has_time(PayloadUse use) {
  return use != PayloadUse::kWhole && use != PayloadUse::kBeginning;
}
constexpr bool is_whole(PayloadUse use) {
  return use == PayloadUse::kWhole || use == PayloadUse::kWholeLater;
}
inline constexpr std::size_t kBeginningSize = 512;  // bytes
// The bytes that a reader gets of a payload of `size` bytes.
constexpr std::size_t given_of(PayloadUse use, std::size_t size) {
  if (use == PayloadUse::kHeader) return 0;
  return is_whole(use) ? size : std::min(size, kBeginningSize);
}

struct ReaderOptions {
  std::string topic;  // DDS names
  std::string type;
  rtps::Qos qos;
  PayloadUse payload = PayloadUse::kWhole;
  std::string user_data;
  MatchCallback on_match;  // may be empty
  // For best effort readers: called if a writer is alive and writes, but its samples cannot be
  // reassembled. They are too large, or lost in part, or somebody forged their numbers. May be
  // empty; called like SampleCallback, once for each such sample, after the first few.
  std::function<void()> on_unheard{};
};

struct WriterOptions {
  std::string topic;
  std::string type;
  rtps::Qos qos;
  std::string user_data;
  MatchCallback on_match;
  // kSoon: acknowledgements may come as late as samples of readers that have time, and so what was lost is sent
  // again later.
  rtps::Haste haste = rtps::Haste::kNow;
};

class Reader {
 public:
  class Impl;
  explicit Reader(std::unique_ptr<Impl> impl);
  ~Reader();

  const rtps::Guid& guid() const;

 private:
  std::unique_ptr<Impl> impl_;
};

class Writer {
 public:
  class Impl;
  explicit Writer(std::unique_ptr<Impl> impl);
  ~Writer();

  const rtps::Guid& guid() const;

  // The sequence number of the sample, or nothing when the middleware refused it. `payload` starts
  // with its encapsulation. The sample may have been answered when this returns.
  std::optional<std::int64_t> write(rtps::ByteView payload,
                                    const rtps::SampleIdentity& related = {});

  // Gives up on what is not acknowledged yet: it is not sent again.
  void forget_unacknowledged();

  // Whether every matched reader has acknowledged all that was written. Does not wait.
  bool is_acknowledged() const;

 private:
  std::unique_ptr<Impl> impl_;
};

// Outlives its readers and writers.
class Participant {
 public:
  class Impl;
  static Expected<std::unique_ptr<Participant>> create(const ParticipantOptions& options,
                                                       DiscoveryCallback on_discovery);
  explicit Participant(std::unique_ptr<Impl> impl);
  ~Participant();

  const rtps::Guid& guid() const;

  // Sends nothing more but the goodbye at its end, which announces the end of all its readers and
  // writers at once: for a participant with many endpoints that ends. @pre nothing more is created
  // or written.
  void leave();

  // While one of these lives, no announcement is sent. Endpoints that are created meanwhile are
  // announced together, a tenth of a second after the next endpoint, which is announced at once.
  // The others then ask for the missing ones, and get them in few datagrams instead of one for each
  // endpoint and participant. For callers that create many endpoints in one go, and have time. Its
  // life must be short. In a secured domain it does nothing.
  class Hold {
   public:
    explicit Hold(Participant& participant);
    ~Hold();
    Hold(const Hold&) = delete;
    Hold& operator=(const Hold&) = delete;

   private:
    Impl& participant_;
  };

  // While one of these lives, samples to readers and writers that have time do not come late. For a
  // caller that waits for an answer.
  class Hurry {
   public:
    explicit Hurry(Participant& participant);
    ~Hurry();
    Hurry(const Hurry&) = delete;
    Hurry& operator=(const Hurry&) = delete;

   private:
    Impl& participant_;
  };

  // Calls `on_round`, on the thread that receives, whenever the readers were handed what came together.
  void on_round(std::function<void()> on_round);

  // Where the datagrams of another participant came from so far.
  rtps::DatagramSources::Origin origin_of(const rtps::GuidPrefix& participant) const;
  // Its process is this one, on this machine: from now on only what comes from that process counts as its (Origins).
  void prove(const rtps::GuidPrefix& participant, int pid);
  rtps::Origins& origins();
  // When its last one came; kLongAgo: it is not there.
  Time heard_last(const rtps::GuidPrefix& participant) const;
  // Since when no own datagram came through one of its ports (DatagramSources). Every second
  // something should.
  Time own_came_through() const;
  // Whether the thread that receives is at work (ReceiveWatch): looks, and until when it was.
  void look_at_receivers(Time now);
  Time receivers_attended() const;
  // The datagrams that were kept from the middleware.
  rtps::DatagramFilter::Refused refused() const;
  // Datagrams that our own full sockets dropped so far (ReceiveThread). Within the callback of a sample: before it.
  std::uint64_t dropped_here() const;

  // An error when the middleware refuses: one participant cannot have a topic with two types.
  Expected<std::unique_ptr<Reader>> create_reader(ReaderOptions options, SampleCallback on_sample);
  Expected<std::unique_ptr<Writer>> create_writer(WriterOptions options);

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace culprit::ros2
