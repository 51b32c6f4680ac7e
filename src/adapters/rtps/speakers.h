// In whose names a datagram speaks: the participant of its header (RTPS 2.3 §8.3.7), and those that INFO_SRC
// submessages put in its place (§8.3.7.9).
#pragma once

#include <cstdint>
#include <cstring>
#include <span>

#include "base/mutex.h"
#include "rtps/guid.h"
#include "rtps/submessage.h"

namespace culprit::rtps {

inline GuidPrefix prefix_at(std::span<const std::uint8_t> bytes, std::size_t position) {
  GuidPrefix prefix;
  std::memcpy(prefix.bytes.data(), bytes.data() + position, prefix.bytes.size());
  return prefix;
}

inline bool is_rtps(std::span<const std::uint8_t> datagram) {
  return datagram.size() >= kHeader && std::memcmp(datagram.data(), "RTPS", 4) == 0;
}

inline constexpr std::size_t kPrefixInHeader = 8;

// Calls `found` with each of them; the caller holds what that requires. @pre is_rtps(datagram)
template <class Found>
void for_each_speaker(std::span<const std::uint8_t> datagram, Found found) CULPRIT_NOT_ANALYZED {
  constexpr std::size_t kPrefixInInfoSource = kSubmessageHeader + 8;
  found(prefix_at(datagram, kPrefixInHeader));
  bool is_sure_of_place = true;
  for (std::size_t at = kHeader; at + kSubmessageHeader <= datagram.size();) {
    if (datagram[at] == kInfoSource && at + kPrefixInInfoSource + 12 <= datagram.size())
      found(prefix_at(datagram, at + kPrefixInInfoSource));
    if (!is_sure_of_place) {
      ++at;
      continue;
    }
    const bool is_little = (datagram[at + 1] & 1) != 0;
    const std::size_t low = datagram[at + (is_little ? 2 : 3)];
    const std::size_t high = datagram[at + (is_little ? 3 : 2)];
    const std::size_t length = high << 8 | low;
    const bool reaches_the_end = length == 0 && datagram[at] != kPad && datagram[at] != kInfoTime;
    if (reaches_the_end) return;
    // Implementations differ in where they go on after an odd length: then each place may count.
    is_sure_of_place = length % 4 == 0;
    at += kSubmessageHeader + length;
  }
}

}  // namespace culprit::rtps
