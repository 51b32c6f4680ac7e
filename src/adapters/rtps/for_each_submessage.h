// The submessages of an RTPS message (RTPS 2.3 §9.4.1).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/invariant.h"
#include "base/mutex.h"
#include "rtps/cdr.h"
#include "rtps/speakers.h"
#include "rtps/submessage.h"

namespace culprit::rtps {

inline std::uint16_t number_at(ByteView bytes, std::size_t at, bool is_little) {
  return static_cast<std::uint16_t>(is_little ? bytes[at] | bytes[at + 1] << 8
                                              : bytes[at] << 8 | bytes[at + 1]);
}

// The size of a list of parameters with its end marker, or of all bytes if it has none (RTPS 2.3 §9.4.2.11).
inline std::size_t size_of_parameters(ByteView bytes, bool is_little) {
  constexpr std::uint16_t kEnd = 1;
  for (std::size_t at = 0; at + 4 <= bytes.size();) {
    const std::size_t length = number_at(bytes, at + 2, is_little);
    if (number_at(bytes, at, is_little) == kEnd) return at + 4;
    at += 4 + ((length + 3) & ~std::size_t{3});
  }
  return bytes.size();
}

// Puts padding in the place of a submessage, which may have had no length of its own.
inline void pad(std::span<std::uint8_t> place) {
  CULPRIT_ASSERT(place.size() >= kSubmessageHeader);
  const std::size_t length = place.size() - kSubmessageHeader;
  place[0] = kPad;
  place[1] = 1;  // little endian
  place[2] = static_cast<std::uint8_t>(length);
  place[3] = static_cast<std::uint8_t>(length >> 8);
}

// Calls `found` with each submessage, its header included; the caller holds what that requires. Stops at the first
// damaged one.
template <class Found>
void for_each_submessage(ByteView datagram, Found found) CULPRIT_NOT_ANALYZED {
  if (!is_rtps(datagram)) return;
  for (ByteView rest = datagram.subspan(kHeader); rest.size() >= kSubmessageHeader;) {
    const std::size_t length = number_at(rest, 2, (rest[1] & 1) != 0);
    const bool is_last = length == 0 && rest[0] != kPad && rest[0] != kInfoTime;
    const std::size_t size = is_last ? rest.size() : kSubmessageHeader + length;
    if (size > rest.size()) return;
    found(rest.first(size));
    rest = rest.subspan(std::min(rest.size(), (size + 3) & ~std::size_t{3}));
  }
}

}  // namespace culprit::rtps
