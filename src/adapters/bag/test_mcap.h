// For tests: writes MCAP as a recorder does (mcap.dev/spec), and as none should. Its codes and fields
// are its own: a wrong one in mcap/record.h would agree with itself.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <zlib.h>
#include <zstd.h>

#include <lz4frame.h>

#include "bag/test_bag.h"

namespace culprit::bag::test {

inline std::string little(std::uint64_t number, int size) {
  std::string bytes;
  for (int i = 0; i < size; ++i, number >>= 8) bytes += static_cast<char>(number);
  return bytes;
}
inline std::string text(std::string_view content) {
  return little(content.size(), 4) + std::string(content);
}
inline std::string record(std::uint8_t code, const std::string& body) {
  return std::string(1, static_cast<char>(code)) + little(body.size(), 8) + body;
}
inline std::uint32_t checksum(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

inline std::string zstd(std::string_view bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  out.resize(ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), 1));
  return out;
}
inline std::string lz4(std::string_view bytes) {
  std::string out(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
  out.resize(LZ4F_compressFrame(out.data(), out.size(), bytes.data(), bytes.size(), nullptr));
  return out;
}

inline std::string schema(std::uint16_t id, std::string_view type, std::string_view definition) {
  return record(0x03, little(id, 2) + text(type) + text("ros2msg") + text(definition));
}
inline std::string channel(std::uint16_t id, std::uint16_t schema, std::string_view topic,
                           std::string_view encoding = "cdr") {
  return record(0x04, little(id, 2) + little(schema, 2) + text(topic) + text(encoding) + text(""));
}
inline std::string message(std::uint16_t channel, std::uint64_t at, std::string_view bytes) {
  return record(
      0x05, little(channel, 2) + little(0, 4) + little(at, 8) + little(at, 8) + std::string(bytes));
}

// `compression` is "", "zstd" or "lz4". `size` and `sum` are what it says about `records`.
inline std::string chunk(std::string_view records, const std::string& compression,
                         std::uint64_t size, std::uint32_t sum) {
  const std::string packed = compression == "zstd"  ? zstd(records)
                             : compression == "lz4" ? lz4(records)
                                                    : std::string(records);
  return record(0x06, little(0, 16) + little(size, 8) + little(sum, 4) + text(compression) +
                          little(packed.size(), 8) + packed);
}
inline std::string chunk(std::string_view records, const std::string& compression) {
  return chunk(records, compression, records.size(), checksum(records));
}

inline std::string mcap_begin() {
  return std::string("\x89MCAP0\r\n", 8) + record(0x01, text("ros2") + text("test"));
}
// A whole file. `messages` is how many it says there are.
inline std::string mcap(const std::string& data, std::uint64_t messages) {
  const std::string before = mcap_begin() + data;
  return before + record(0x0f, little(checksum(before), 4)) +
         record(0x0b, little(messages, 8) + std::string(46, '\0')) +
         record(0x02, std::string(20, '\0')) + std::string("\x89MCAP0\r\n", 8);
}

// With `most` messages in a chunk that says when they were recorded, as rosbag2 does.
inline void write_mcap(const std::filesystem::path& path, const TestRecording& recording,
                       std::size_t most) {
  std::string data;
  std::map<std::string, std::uint16_t> ids;
  for (const auto& [topic, type] : recording.types) {
    const auto id = static_cast<std::uint16_t>(ids.size() + 1);
    ids[topic] = id;
    data += schema(id, type, "") + channel(id, id, topic);
  }
  for (std::size_t begin = 0; begin < recording.messages.size(); begin += most) {
    std::string records;
    std::uint64_t first = ~std::uint64_t{0};
    std::uint64_t last = 0;
    const std::size_t end = std::min(begin + most, recording.messages.size());
    for (std::size_t m = begin; m < end; ++m) {
      const TestMessage& each = recording.messages[m];
      const auto at = static_cast<std::uint64_t>(each.at);
      first = std::min(first, at);
      last = std::max(last, at);
      records += message(ids[each.topic], at, each.bytes);
    }
    data += record(0x06, little(first, 8) + little(last, 8) + little(records.size(), 8) +
                             little(checksum(records), 4) + text("") + little(records.size(), 8) +
                             records);
  }
  std::ofstream(path, std::ios::binary) << mcap(data, recording.messages.size());
}

}  // namespace culprit::bag::test
