// The records of an MCAP file (mcap.dev/spec, version 0), once for its reader and its writer: their
// codes, and the fields that both know. Each of them keeps by itself what the other does not know.
#pragma once

#include <cstdint>
#include <string_view>
#include <zlib.h>

namespace culprit::mcap {

inline constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);  // at both ends of the file

// The first byte of each record. The size of its fields follows, in 8 bytes.
enum Code : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0b,
  kMetadata = 0x0c,
  kMetadataIndex = 0x0d,
  kSummaryOffset = 0x0e,
  kDataEnd = 0x0f
};
inline constexpr std::size_t kHeadSize = 1 + 8;

struct Schema {
  std::uint16_t id = 0;
  std::string_view name{}, encoding{}, text{};
  static void visit(auto& self, auto&& each) { each(self.id, self.name, self.encoding, self.text); }
};

// Its metadata follows: pairs of texts, after the size of all.
struct Channel {
  std::uint16_t id = 0, schema = 0;
  std::string_view topic{}, encoding{};
  static void visit(auto& self, auto&& each) {
    each(self.id, self.schema, self.topic, self.encoding);
  }
};

// The payload follows.
struct Message {
  static constexpr std::size_t kSize = 2 + 4 + 8 + 8;
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  std::uint64_t logged = 0, published = 0;  // nanoseconds since 1970
  static void visit(auto& self, auto&& each) {
    each(self.channel, self.sequence, self.logged, self.published);
  }
};

// Its records follow.
struct Chunk {
  std::uint64_t first = 0, last = 0;  // times of its messages
  std::uint64_t size = 0;             // of its records before they were compressed
  std::uint32_t checksum = 0;         // likewise; 0: none
  std::string_view compression{};
  std::uint64_t compressed_size = 0;
  static void visit(auto& self, auto&& each) {
    each(self.first, self.last, self.size, self.checksum, self.compression, self.compressed_size);
  }
};

inline std::uint32_t checksum_of(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

}  // namespace culprit::mcap
