// The other participants that a datagram speaks of, in its sender's own name.
//
// Each participant announces itself and its own endpoints, and their end (RTPS 2.3 §8.5). Fast DDS
// believes any sender's announcement of any participant: it looks at the key, not at the writer. A
// discovery server alone has a reason to speak of others.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rtps/guid.h"

namespace culprit::rtps {

// The participants, each once, whose keys are in the datagram's discovery data and that are not its sender: at most
// kMostOthers, and one more if there are more. It cannot see into encrypted data. Announcements in fragments are put together
// first (announcement_fragments.h).
inline constexpr std::size_t kMostOthers = 64;
std::vector<GuidPrefix> others_announced(std::span<const std::uint8_t> datagram);

// Whether it has more submessages than participants send: thousands of empty ones fit into a datagram, and each costs
// the middleware time.
inline constexpr int kMostSubmessages = 1000;
bool has_too_many_submessages(std::span<const std::uint8_t> datagram);

// Whether it speaks for more participants than a datagram needs to: for each one, its origin is looked up. A relay
// speaks for a few.
inline constexpr int kMostSpeakers = 64;
bool has_too_many_speakers(std::span<const std::uint8_t> datagram);

// Whether it announces a participant.
bool introduces(std::span<const std::uint8_t> datagram);

// Whether somebody acknowledges what `self` has written: an answer to its heartbeats (RTPS 2.3 §8.3.7.1), which
// participants owe one another from their discovery on.
bool acknowledges(std::span<const std::uint8_t> datagram, const GuidPrefix& self);

}  // namespace culprit::rtps
