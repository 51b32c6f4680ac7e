// Decides which culprit manages a robot, of those on different machines in its DDS domain. (On one
// machine a lock decides, live/host_claim.h.)
//
// Each culprit announces its claim by writers on the hidden topic /_culprit_lease. Their user data
// hold the robot, the nodes, the start time, and the term; a culprit that takes over has a term one
// higher than any before. The culprit with the highest term manages; among equal terms, the one
// that began first, by its own clock; of two that began at once, the one with the lower id. All
// reach the same result, so a robot has one manager also after a partitioned network has come
// together. If two name different robots and the same node, the one that began first has that node.
//
// Each culprit writes a beat there every quarter of a second, as long as it receives its own
// messages. A culprit that ends in order loses its lease at once. One whose beats stay away for
// kPatience has lost it, too, though its DDS lease lasts 20 s. A manager that could not send its
// beats may have lost the lease without knowing: it listens for kListen before it goes on, and
// steps back if another has taken over. Each beat carries people's orders for the robot, for the
// successor.
//
// Beside the beats a manager sends the other state that a successor needs (its beliefs and
// attempts; opaque here). It goes in parts of one datagram each, with the time of the sender's
// clock:
//
//     proof=...;state=1;round=7;part=0;of=2;clock=81234567890;<bytes>
//
// All parts of a round are of one state. A round begins when there is something new to send, and
// every kStatePeriod. A culprit that does not know these messages takes them for beats without a
// proof, and ignores them; so does this one with those of another version.
//
// Anybody in the domain could announce so. A claim or a beat counts if it carries a proof that its
// participant knows the shared key. The proof is an HMAC-SHA-256 over it and the participant's GUID
// prefix. Beats are numbered, so that an old one is not taken for a new one. A claim without a
// proof is a stranger's: it is reported, and culprit does not yield to it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/time.h"
#include "ros2/participant.h"

namespace culprit::link {

struct LeaseClaim {
  std::string robot;
  std::int64_t since = 0;  // nanoseconds since 1970
  std::int64_t id = 0;     // of the process: random
  // The nodes that it adapts, by full name; "*/camera" for a node of that own name in any
  // namespace.
  std::vector<std::string> nodes{};
  std::string key{};  // shared by culprits that trust each other; empty: only our own claim counts
  std::int64_t term = 0;  // how often the robot was taken over, as far as it is known
};

class ManagerLease {
 public:
  static constexpr const char* kTopic = "rt/_culprit_lease";
  static constexpr const char* kType = "culprit::msg::dds_::Lease_";
  static constexpr Duration kPeriod = std::chrono::milliseconds(250);
  static constexpr Duration kPatience = std::chrono::milliseconds(1500);
  // A manager whose beats stayed away for so long may count as exited, less the time that they need
  // to arrive.
  static constexpr Duration kAway = std::chrono::milliseconds(1000);
  // Longer than it takes to take over, and to announce it.
  static constexpr Duration kListen = std::chrono::milliseconds(3000);
  static constexpr std::size_t kLongestBeat = 48 * 1024;  // one UDP datagram
  static constexpr Duration kStatePeriod = std::chrono::seconds(1);
  static constexpr std::size_t kLongestPart = 40 * 1024;
  static constexpr std::size_t kMostParts = 16;
  static constexpr std::size_t kPartsAtOnce = 4;  // with one beat
  static constexpr std::size_t kLongestState = kMostParts * kLongestPart;

  // `self` is the participant that announces it.
  ManagerLease(LeaseClaim own, rtps::GuidPrefix self) : own_(std::move(own)), self_(self) {}

  // The user data of the own writers: one for each, for not all nodes may fit into one.
  std::vector<std::string> announcements() const;
  void apply(const ros2::DiscoveryEvent& event, Time now);

  // To be called every kPeriod. `hears`: messages of others arrive now. Gives the beat to be
  // written; nothing if no other culprit would believe it, or none should rely on this one now.
  // `orders`: people's orders; sent only if it manages, and left out if it is too long.
  std::optional<std::string> beat(Time now, bool hears, bool manages, const std::string& orders);
  // Sets the state for a successor; if it is longer than kLongestState, none is sent.
  void tell_state(std::string state);
  // To be called after each beat that was given. Gives the parts to be written with it.
  std::vector<std::string> state_parts(Time now);
  // The state that the last manager of this robot sent, if it is complete.
  struct ToldState {
    std::string text;
    Duration shift;  // what our clock showed when it came, minus what theirs showed
  };
  const std::optional<ToldState>& told_state() const { return told_state_; }
  // This culprit manages from now on, in this term: announcements() contain it, and the orders and
  // state from others no longer count. Does not announce anything itself.
  void take_over(std::int64_t term);
  // A message that a writer of this participant wrote.
  void hear(const rtps::GuidPrefix& participant, std::string_view beat, Time now);
  // Until when it is certain that no other culprit has taken over from this manager without our
  // knowing it. Not later than `now`: it is not.
  Time sure_until(Time now) const;
  // The orders in the latest beat of another manager of this robot; empty: it sent none. Nothing:
  // no such beat arrived.
  const std::optional<std::string>& told_orders() const { return told_orders_; }
  // The highest term that was proven.
  std::int64_t highest_term() const { return highest_term_; }

  // Participants that are left out: those of this machine.
  using IsLeftOut = std::function<bool(const rtps::GuidPrefix&)>;

  // The participant of the culprit that goes before this one; nothing if this one manages.
  std::optional<rtps::GuidPrefix> elder(Time now, const IsLeftOut& is_left_out = {}) const;
  // The participant of a culprit of another robot that goes before this one at the node of this
  // full name.
  std::optional<rtps::GuidPrefix> elder_at(const std::string& node, Time now,
                                           const IsLeftOut& is_left_out = {}) const;
  // The participants that claim this robot, or a node of it, without a proof.
  std::vector<rtps::GuidPrefix> strangers(const IsLeftOut& is_left_out = {}) const;

 private:
  static constexpr std::size_t kMostStrangers = 100;  // that are kept track of

  using Age = std::pair<std::int64_t, std::int64_t>;  // since when, id
  using Rank = std::pair<std::int64_t, Age>;          // the term, negative
  struct Other {
    std::string robot;
    std::int64_t term = 0;
    Age age;
    std::vector<std::string> nodes;
    bool is_proven = false;

    Rank rank() const { return {-term, age}; }
  };
  struct Life {
    Time heard;  // or discovered
    std::uint64_t beats = 0;
  };

  // A round of another one's state, as far as it came.
  struct Round {
    std::uint64_t number = 0;
    std::vector<std::optional<std::string>> parts;
  };

  void hear_state(const rtps::GuidPrefix& participant, std::string_view proof,
                  std::string_view part, Time now);
  Age own_age() const { return {own_.since, own_.id}; }
  bool concerns_us(const Other& other) const;
  bool is_alive(const rtps::GuidPrefix& participant, Time now) const;
  template <class Predicate, class Order>
  std::optional<rtps::GuidPrefix> first(Time now, const IsLeftOut& is_left_out, Predicate is_rival,
                                        Order order) const;

  LeaseClaim own_;
  rtps::GuidPrefix self_;
  std::map<rtps::Guid, Other> others_;      // that concern us
  std::map<rtps::GuidPrefix, Life> lives_;  // of those that are proven
  std::int64_t highest_term_ = 0;
  std::optional<std::string> told_orders_;
  std::map<rtps::GuidPrefix, Round> rounds_;  // of those that are proven
  std::optional<ToldState> told_state_;
  std::string state_;          // that we send
  bool is_state_new_ = false;  // and did not begin to
  std::string round_state_;    // that the present round sends
  std::uint64_t round_ = 0;    // its number; 0: there was none
  std::size_t next_part_ = 0;  // of it
  std::size_t parts_ = 0;      // it has
  Time round_began_ = kLongAgo;
  std::uint64_t beats_ = 0;   // that we sent
  std::optional<Time> said_;  // the latest of them
  bool has_friends_ = false;  // some were proven
  bool manages_ = false;
  Time ticked_ = kLongAgo;       // when we were last asked for a beat
  Time hears_since_ = kLongAgo;  // messages arrive without a gap since then
  Time listens_until_ = kLongAgo;
};

}  // namespace culprit::link
