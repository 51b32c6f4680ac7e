// How an RTPS message is laid out, as far as it is looked at before Fast DDS sees it (RTPS 2.3
// §9.4.4, §9.4.5): a header, then submessages, each with a kind, flags and a length.
#pragma once

#include <cstddef>
#include <cstdint>

namespace culprit::rtps {

inline constexpr std::size_t kHeader = 20;           // bytes
inline constexpr std::size_t kSubmessageHeader = 4;  // bytes

enum SubmessageKind : std::uint8_t {
  kPad = 0x01,
  kAckNack = 0x06,
  kHeartbeat = 0x07,
  kGap = 0x08,
  kInfoTime = 0x09,
  kInfoSource = 0x0c,
  kInfoReplyIp4 = 0x0d,
  kInfoDestination = 0x0e,
  kInfoReply = 0x0f,
  kNackFragment = 0x12,
  kHeartbeatFragment = 0x13,
  kData = 0x15,
  kDataFragment = 0x16
};

// Flags of samples and fragments (RTPS 2.3 §9.4.5.3.1); the last two of samples only.
inline constexpr std::uint8_t kHasParameters = 0x02;
inline constexpr std::uint8_t kHasPayload = 0x04;
inline constexpr std::uint8_t kHasKey = 0x08;

// It only changes the meaning of those that follow.
inline bool is_about_others(std::uint8_t kind) {
  return kind == kPad || kind == kInfoTime || (kind >= kInfoSource && kind <= kInfoReply);
}

}  // namespace culprit::rtps
