#include "ros2/discovery_info.h"

#include <algorithm>

namespace culprit::ros2 {
namespace {

constexpr std::size_t kGuidSize = sizeof(rtps::Guid::bytes);

rtps::Guid read_gid(rtps::CdrReader& reader, GidSize size) {
  rtps::Guid guid;
  const rtps::ByteView bytes = reader.read_bytes(static_cast<std::size_t>(size));
  if (!bytes.empty()) std::copy_n(bytes.begin(), kGuidSize, guid.bytes.begin());
  return guid;
}

std::vector<rtps::Guid> read_gids(rtps::CdrReader& reader, GidSize size) {
  std::vector<rtps::Guid> gids(reader.read_count(static_cast<std::size_t>(size)));
  for (rtps::Guid& gid : gids) gid = read_gid(reader, size);
  return gids;
}

void write_gid(rtps::CdrWriter& writer, const rtps::Guid& guid, GidSize size) {
  std::array<std::uint8_t, static_cast<std::size_t>(GidSize::kHumbleAndOlder)> bytes{};
  std::ranges::copy(guid.bytes, bytes.begin());
  writer.write_bytes(rtps::ByteView(bytes).first(static_cast<std::size_t>(size)));
}

void write_gids(rtps::CdrWriter& writer, const std::vector<rtps::Guid>& guids, GidSize size) {
  writer.write(static_cast<std::uint32_t>(guids.size()));
  for (const rtps::Guid& guid : guids) write_gid(writer, guid, size);
}

}  // namespace

GidSize gid_size_of(rtps::ByteView payload) {
  constexpr std::size_t kSmallestOld = rtps::kEncapsulationSize + 24 + sizeof(std::uint32_t);
  if (payload.size() < kSmallestOld) return GidSize::kIronAndNewer;
  const rtps::ByteView tail = payload.subspan(rtps::kEncapsulationSize + kGuidSize, 8);
  const bool zeros = std::ranges::all_of(tail, [](std::uint8_t b) { return b == 0; });
  return zeros ? GidSize::kHumbleAndOlder : GidSize::kIronAndNewer;
}

std::optional<DiscoveryInfo> decode_discovery_info(rtps::ByteView payload) {
  const GidSize size = gid_size_of(payload);
  rtps::CdrReader reader(payload);
  DiscoveryInfo info;
  info.participant = read_gid(reader, size);
  constexpr std::size_t kSmallestNode = 4 * sizeof(std::uint32_t);  // two strings and two sequences
  for (std::uint32_t n = reader.read_count(kSmallestNode); n > 0 && reader.ok(); --n) {
    NodeEntities& node = info.nodes.emplace_back();
    node.name_space = reader.read_string();
    node.name = reader.read_string();
    node.readers = read_gids(reader, size);
    node.writers = read_gids(reader, size);
  }
  if (!reader.ok()) return std::nullopt;
  return info;
}

rtps::Bytes encode_discovery_info(const DiscoveryInfo& info, GidSize size) {
  rtps::CdrWriter writer;
  write_gid(writer, info.participant, size);
  writer.write(static_cast<std::uint32_t>(info.nodes.size()));
  for (const NodeEntities& node : info.nodes) {
    writer.write_string(node.name_space);
    writer.write_string(node.name);
    write_gids(writer, node.readers, size);
    write_gids(writer, node.writers, size);
  }
  return writer.take();
}

}  // namespace culprit::ros2
