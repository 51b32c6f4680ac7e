// Who is who on the wire: a participant is twelve bytes, each of its readers and writers four more
// (RTPS 2.3 §8.2.4).
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <cstring>
#include <functional>

namespace culprit::ros2 {

// Identifies a participant: one per process and DDS domain, as a rule, and new with each start of
// it.
struct GuidPrefix {
  std::array<std::uint8_t, 12> bytes{};
  auto operator<=>(const GuidPrefix&) const = default;
};

// Identifies a reader or writer, or with the entity id 00 00 01 c1 the participant itself. Bytes in
// RTPS order.
struct Guid {
  std::array<std::uint8_t, 16> bytes{};
  auto operator<=>(const Guid&) const = default;

  GuidPrefix prefix() const {
    GuidPrefix p;
    std::memcpy(p.bytes.data(), bytes.data(), p.bytes.size());
    return p;
  }
  // Entity kinds (RTPS 2.3 §9.3.1.2): readers are 0x04 and, with keys, 0x07, writers 0x03 and, with
  // keys, 0x02.
  bool is_reader() const { return (bytes[15] & 0x04) != 0; }
  bool has_keys() const { return (bytes[15] & 0x07) == 0x02 || (bytes[15] & 0x07) == 0x07; }
};

// The identity of one sample: the RTPS sequence number that its writer gave it. All zero: none.
struct SampleIdentity {
  Guid writer;
  std::int64_t sequence = 0;
  bool operator==(const SampleIdentity&) const = default;
};

}  // namespace culprit::ros2

template <>
struct std::hash<culprit::ros2::GuidPrefix> {
  std::size_t operator()(const culprit::ros2::GuidPrefix& prefix) const noexcept {
    // FNV-1a: the bytes come from the network, but the tables that use this are capped.
    std::uint64_t h = 0xcbf29ce484222325;
    for (const std::uint8_t b : prefix.bytes) h = (h ^ b) * 0x100000001b3;
    return h;
  }
};

template <>
struct std::hash<culprit::ros2::Guid> {
  std::size_t operator()(const culprit::ros2::Guid& guid) const noexcept {
    std::uint64_t h = 0xcbf29ce484222325;
    for (const std::uint8_t b : guid.bytes) h = (h ^ b) * 0x100000001b3;
    return h;
  }
};
