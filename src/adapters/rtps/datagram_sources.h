// Records from which sockets the datagrams of each participant come.
//
// A participant's announcement is a claim, its addresses too. The source of its datagrams is not:
// the kernel drops a datagram from the network that pretends to come from an address of this
// machine. So the transport writes down, before the middleware sees a datagram, from which address
// it came, under every participant that it speaks for: the one of its header (RTPS 2.3 §8.3.7), and
// those that INFO_SRC submessages put in its place (§8.3.7.9). A forger's own address is recorded
// here before the datagram has any effect.
//
// It also proves that the receive thread works: the datagrams that this participant sends to its
// own ports must arrive at each of them again and again.
//
// Bounded: participants that were discovered are kept while they are there; of the others, the most
// recent ones. A participant with too many addresses is marked as such.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <list>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/mutex.h"
#include "base/time.h"
#include "rtps/guid.h"

namespace culprit::rtps {

using Ip = std::array<std::uint8_t, 4>;

struct UdpAddress {
  Ip ip{};
  std::uint16_t port = 0;
  auto operator<=>(const UdpAddress&) const = default;
};

// "10.0.0.5:7410"
std::string to_text(const UdpAddress& address);

// All members may be called from any thread.
class DatagramSources {
 public:
  static constexpr std::size_t kMostAddresses = 64;       // of one participant
  static constexpr std::size_t kMostParticipants = 8192;  // kept
  static constexpr std::size_t kMostOthers = 1024;

  struct Origin {
    std::vector<UdpAddress> addresses;  // in the order of their first datagrams
    bool is_complete = false;           // false: nothing came, or from more than these
    bool operator==(const Origin&) const = default;
  };

  void heard(std::span<const std::uint8_t> datagram, const UdpAddress& from, Time now);
  // Whether it only repeats, in plain text, that a participant is there that was discovered, and is
  // kept (RTPS 2.3 §8.5.3). The content of the announcement may have changed.
  bool is_still_there(std::span<const std::uint8_t> datagram) const;

  // It was discovered: it is kept until it is forgotten.
  void keep(const GuidPrefix& participant);
  void forget(const GuidPrefix& participant);

  Origin of(const GuidPrefix& participant) const;
  // False only for one that was discovered, and is known to have sent from other addresses alone.
  bool may_speak_from(const GuidPrefix& participant, const UdpAddress& from) const;
  // When the last one came; kLongAgo: nothing came, or it is not kept any more.
  Time last_of(const GuidPrefix& participant) const;

  // The participant that receives.
  void begin(const GuidPrefix& self);
  // The middleware has taken what came to this unicast port.
  void came_through(std::span<const std::uint8_t> datagram, std::uint16_t port, Time now);
  // Since when the own datagrams are missing at the port where they have been missing for longest,
  // of the ports that ever received one. kNever: none did.
  Time own_came_through() const;

 private:
  static constexpr std::size_t kMostPorts = 16;

  struct Entry {
    std::vector<UdpAddress> addresses;
    bool has_more = false;
    bool is_kept = false;
    Time last = kLongAgo;
    std::list<GuidPrefix>::iterator place;  // in others_, unless it is kept
  };

  void note(const GuidPrefix& participant, const UdpAddress& from, Time now)
      CULPRIT_REQUIRES(mutex_);

  mutable Mutex mutex_;
  std::unordered_map<GuidPrefix, Entry> entries_ CULPRIT_GUARDED_BY(mutex_);
  std::list<GuidPrefix> others_
      CULPRIT_GUARDED_BY(mutex_);  // those that are not kept, oldest first
  std::optional<GuidPrefix> self_ CULPRIT_GUARDED_BY(mutex_);
  std::vector<std::pair<std::uint16_t, Time>> ports_
      CULPRIT_GUARDED_BY(mutex_);  // when datagrams of our own came through last
};

}  // namespace culprit::rtps
