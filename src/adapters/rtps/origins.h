// Decides which datagrams count: those that come from the known place of the participant in whose name they speak.
//
// RTPS does not prove the sender of a datagram. The kernel does, for senders on this machine: its table of sockets
// shows which process owns the source address. Once the process of a participant is known
// (prove()), a datagram in its name counts only from a socket of that process. (The name is in the
// header or in INFO_SRC, RTPS 2.3 §8.3.7.) Others are dropped before they have any effect.
//
// The process may be unknown: it runs on another computer or in a container. Its participant is bound to the IP
// addresses that it spoke from and announced; all addresses of this machine count as one. It is bound once it has
// answered us and only these addresses spoke in its name for kAlone. It may move: another address counts after the
// old ones were silent for twice the longest pause so far (kQuiet at least). If several addresses speak in its name
// from the beginning, it stays unbound, and everything counts.
//
// This stops programs on other machines, and programs on this machine that only have sockets of their own. The
// kernel itself drops datagrams from the network whose source is an address of this machine.
//
// This does not stop:
//   - anything before a process is proven or a participant bound. A process cannot be proven if it belongs to
//     another user (without CAP_SYS_PTRACE), or to another PID or network namespace (a container). Its participant
//     is bound to addresses only, and other programs of that computer or container share them.
//   - another machine can write the address of a third one into its datagrams, as nothing on the way forbids it.
//   - root and CAP_NET_RAW can write any source into a datagram on the loopback interface.
//   - the same user can take a socket out of the process (pidfd_getfd), or run code in it (ptrace).
//   - a program with thousands of sockets makes the tables slow to read; then a datagram from a socket that was not
//     looked up counts (see below).
// So none of this replaces the rule that a claim ends no process; the code that acts must keep it.
//
// A process may open sockets later, and others get its old ports. So an unknown address is looked up at once, and
// the known ones are checked again and again (check()). One look takes a fraction of a millisecond. More than a
// twentieth of the time is never spent on looks. A datagram whose source cannot be looked up counts: missing a
// robot's messages is worse than a forged datagram, which culprit asks about before it acts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/mutex.h"
#include "base/time.h"
#include "rtps/datagram_sources.h"
#include "rtps/guid.h"
#include "rtps/own_addresses.h"
#include "rtps/udp_sockets.h"

namespace culprit::rtps {

// A source of datagrams in another participant's name, or about another participant.
struct ForeignSource {
  UdpAddress from;               // of its first one
  std::optional<unsigned> user;  // of this machine, that made its socket, as far as that is known
  GuidPrefix in_name_of{};       // of its first one
  int pid = 0;                   // the process in whose name it speaks; 0: it is not known
  bool operator==(const ForeignSource&) const = default;
};

// All members may be called from any thread.
class Origins {
 public:
  static constexpr Duration kFresh = std::chrono::milliseconds(20);
  static constexpr int kShareOfTime = 20;  // looks take no more than one part in so many
  static constexpr Duration kForeignFor = std::chrono::seconds(1);
  // For so long after the end of a process no other one may speak in its name: leases of
  // participants run that long.
  static constexpr Duration kAfterEnd = std::chrono::seconds(30);
  // A process may take so long to end: its threads, one after the other, close its sockets.
  static constexpr Duration kEnds = std::chrono::seconds(1);
  static constexpr std::size_t kMostAddresses = 64;  // kept of one participant that are not its own
  static constexpr std::size_t kMostSources = 64;    // that are reported

  // For a participant whose process is unknown (above).
  static constexpr Duration kAlone = std::chrono::seconds(5);
  static constexpr Duration kQuiet = std::chrono::seconds(4);
  static constexpr Duration kLongestQuiet = std::chrono::seconds(20);
  static constexpr std::size_t kMostIps = 16;  // that it may have

  // `proc` is where the proc file system is mounted. `clock` measures how long a look takes.
  explicit Origins(std::filesystem::path proc = "/proc",
                   std::function<std::set<Ip>()> own = own_addresses,
                   std::function<Time()> clock = {});

  // The participant is of this process of this machine, and spoke from these addresses so far. Gives whether all of
  // them are of that process. If not, earlier datagrams in its name may be false: it is to be
  // discovered again.
  bool prove(const GuidPrefix& participant, int pid, std::span<const UdpAddress> spoke_from);
  bool is_proven(const GuidPrefix& participant) const;
  // One that is to be discovered again, once. It is forgotten meanwhile, but not where it speaks from.
  std::optional<GuidPrefix> take_doubtful();
  void forget(const GuidPrefix& participant);

  // Participants are bound to addresses, by their acknowledgements to `self`. Not in a secured
  // domain, where the middleware has a better proof.
  void begin_to_bind(const GuidPrefix& self);
  // It was discovered, or announced itself again: at these addresses.
  void discovered(const GuidPrefix& participant, std::span<const UdpAddress> announced, Time now);

  // False if its source is known not to be that of the participants in whose names it speaks.
  bool counts(std::span<const std::uint8_t> datagram, const UdpAddress& from, Time now);

  // Whether a datagram from there may announce something of another participant than its sender, in
  // its sender's own name (claims.h): only from where that one speaks itself, too. `has_spoken`:
  // one in that participant's name came from there, or that participant is not known.
  bool may_tell_of(const GuidPrefix& other, const UdpAddress& from, bool has_spoken, Time now);

  // Looks whether the addresses that are known are still those of their processes. To be called about once a
  // second; a millisecond.
  void check(Time now);

  // How many datagrams were dropped.
  std::uint64_t dropped() const;
  // The sources that were not reported yet, each once.
  std::vector<ForeignSource> new_sources();

 private:
  struct Socket {
    UdpAddress address;  // ip 0.0.0.0: any of this machine
    std::string link;
    bool is_shared = false;  // sockets of other processes have the same address
    bool has(const UdpAddress& from) const;
  };
  struct Foreign {
    Time since{};                  // when that was found
    std::optional<unsigned> user;  // that made the socket there
  };
  struct Proven {
    int pid = 0;
    std::uint64_t began = 0;  // ticks: numbers of processes are given again
    std::vector<Socket> sockets;
    bool spoke_alone = false;  // from a socket that it does not share
    Time looked = kLongAgo;
    std::optional<Time> ending;             // it was found not to run any more
    std::optional<Time> ended;              // and its sockets to be closed
    bool is_forgotten_once = false;         // to be discovered again
    std::map<UdpAddress, Foreign> foreign;  // addresses that are not its
  };
  // One whose process is not known.
  struct Elsewhere {
    Time since{};          // when it was discovered, or moved
    std::set<Ip> heard{};  // it spoke from there
    std::set<Ip> announced{};
    bool is_bound = false;
    Time last{};         // when it spoke last
    Duration longest{};  // that it paused since it is bound
  };
  enum class Whose : std::uint8_t { kIts, kForeign, kUnknown };

  bool counts(Elsewhere& elsewhere, std::span<const std::uint8_t> datagram, const Ip& from,
              Time now) CULPRIT_REQUIRES(mutex_);

  Whose whose(Proven& proven, const UdpAddress& from, Time now) CULPRIT_REQUIRES(mutex_);
  bool is_of_this_machine(const Ip& ip, Time now) CULPRIT_REQUIRES(mutex_);
  static Whose find(Proven& proven, const UdpAddress& from);
  // False: the tables cannot be read, or are those of another network.
  bool look(Proven& proven, const std::vector<UdpSocket>& table, Time now) CULPRIT_REQUIRES(mutex_);
  bool is_of_this_network(const std::vector<UdpSocket>& table) const CULPRIT_REQUIRES(mutex_);
  static bool end(Proven& proven, const std::vector<UdpSocket>& table, Time now);
  void note(const GuidPrefix& participant, const Proven& proven, const UdpAddress& from)
      CULPRIT_REQUIRES(mutex_);
  void note(const ForeignSource& source) CULPRIT_REQUIRES(mutex_);

  const std::filesystem::path proc_;
  const std::function<std::set<Ip>()> own_;
  const std::function<Time()> clock_;

  mutable Mutex mutex_;
  std::unordered_map<GuidPrefix, Proven> proven_ CULPRIT_GUARDED_BY(mutex_);
  std::unordered_map<GuidPrefix, Elsewhere> elsewhere_ CULPRIT_GUARDED_BY(mutex_);
  std::optional<GuidPrefix> self_ CULPRIT_GUARDED_BY(mutex_);
  std::vector<GuidPrefix> doubtful_ CULPRIT_GUARDED_BY(mutex_);
  std::set<std::string> witnesses_ CULPRIT_GUARDED_BY(mutex_);  // sockets of this process
  std::set<Ip> own_ips_ CULPRIT_GUARDED_BY(mutex_);
  Time asked_for_own_ CULPRIT_GUARDED_BY(mutex_) = kLongAgo;
  Time next_look_ CULPRIT_GUARDED_BY(mutex_) = kLongAgo;
  std::uint64_t dropped_ CULPRIT_GUARDED_BY(mutex_) = 0;
  std::vector<ForeignSource> sources_ CULPRIT_GUARDED_BY(mutex_);  // each once
  std::size_t told_ CULPRIT_GUARDED_BY(mutex_) = 0;                // of them
};

}  // namespace culprit::rtps
