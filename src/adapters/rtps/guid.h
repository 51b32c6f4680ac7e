// Ids on the wire: a participant's is twelve bytes, each of its readers and writers has four more
// (RTPS 2.3 §8.2.4).
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <cstring>
#include <functional>

namespace culprit::rtps {

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

// The hash of an id's bytes in two parts, for the tables in which each datagram is looked up. The
// upper half of a product depends on all bits of its factors. The bytes come from the network:
// those tables are capped.
constexpr std::size_t hash_of(std::uint64_t first, std::uint64_t rest) {
  const std::uint64_t product = (first ^ rest * 0x9e3779b97f4a7c15) * 0xd6e8feb86659fd93;
  return product ^ product >> 32;
}

}  // namespace culprit::rtps

template <>
struct std::hash<culprit::rtps::GuidPrefix> {
  std::size_t operator()(const culprit::rtps::GuidPrefix& prefix) const noexcept {
    std::uint64_t first = 0;
    std::uint32_t rest = 0;
    std::memcpy(&first, prefix.bytes.data(), sizeof first);
    std::memcpy(&rest, prefix.bytes.data() + sizeof first, sizeof rest);
    return culprit::rtps::hash_of(first, rest);
  }
};

template <>
struct std::hash<culprit::rtps::Guid> {
  std::size_t operator()(const culprit::rtps::Guid& guid) const noexcept {
    std::uint64_t first = 0;
    std::uint64_t rest = 0;
    std::memcpy(&first, guid.bytes.data(), sizeof first);
    std::memcpy(&rest, guid.bytes.data() + sizeof first, sizeof rest);
    return culprit::rtps::hash_of(first, rest);
  }
};
