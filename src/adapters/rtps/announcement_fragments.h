// Puts the announcements together that come in fragments (RTPS 2.3 §8.3.7.3), before their keys are compared with their
// sender (claims.h).
//
// Each fragment may name the participant or endpoint that is announced, and the middleware reads the last name. So it gets
// none of them. They become padding, and the whole sample follows as a datagram of its own, which passes all checks. The
// middleware asks for the sample again if fragments are lost; its writer then sends all of them.
//
// An announcement takes some KiB; a larger one than kLargest is dropped. The samples of one socket are limited, and those of
// all: the oldest one makes room.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "base/mutex.h"
#include "rtps/cdr.h"
#include "rtps/datagram_sources.h"

namespace culprit::rtps {

// All members may be called from any thread.
class AnnouncementFragments {
 public:
  static constexpr std::size_t kLargest = 60'000;  // bytes of a sample, with its encapsulation
  static constexpr std::size_t kMostOfSocket = 4;
  static constexpr std::size_t kMost = 64;

  // Until then, datagrams stay as they are. Not in a secured domain: signed datagrams must not be changed.
  void begin();

  // Takes the fragments out of a datagram that came from there. Gives the samples that are whole now.
  std::vector<Bytes> take(std::span<std::uint8_t> datagram, const UdpAddress& from);

 private:
  // The head of a fragment, in the order of bytes of its submessage.
  struct Head {
    std::uint32_t first = 0;  // from 1 on
    std::uint32_t count = 0;
    std::uint32_t fragment_size = 0;  // bytes
    std::uint32_t size = 0;           // of the sample
    ByteView content{};
    std::size_t begin() const { return std::size_t{first - 1} * fragment_size; }
  };
  struct Sample {
    UdpAddress from;  // of its first fragment
    Bytes datagram;   // what comes before the content is complete, and tells samples apart
    std::uint32_t fragment_size = 0;
    std::vector<bool> seen;  // by fragment
    std::size_t missing = 0;
  };

  static std::optional<Head> read_head(ByteView fragment);
  Sample& sample_of(Bytes preamble, const Head& head, const UdpAddress& from)
      CULPRIT_REQUIRES(mutex_);
  // Gives the sample if nothing of it is missing any more.
  std::optional<Bytes> add(Bytes preamble, const Head& head, const UdpAddress& from)
      CULPRIT_REQUIRES(mutex_);

  Mutex mutex_;
  bool has_begun_ CULPRIT_GUARDED_BY(mutex_) = false;
  std::deque<Sample> samples_ CULPRIT_GUARDED_BY(mutex_);  // oldest first
};

}  // namespace culprit::rtps
