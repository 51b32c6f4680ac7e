#include "ros2/discovery_info.h"

#include <algorithm>

namespace culprit::ros2 {
namespace {

constexpr std::size_t kGuidSize = sizeof(Guid::bytes);

Guid read_gid(CdrReader& reader, GidSize size) {
  Guid guid;
  const ByteView bytes = reader.read_bytes(static_cast<std::size_t>(size));
  if (!bytes.empty()) std::copy_n(bytes.begin(), kGuidSize, guid.bytes.begin());
  return guid;
}

std::vector<Guid> read_gids(CdrReader& reader, GidSize size) {
  std::vector<Guid> gids(reader.read_count(static_cast<std::size_t>(size)));
  for (Guid& gid : gids) gid = read_gid(reader, size);
  return gids;
}

void write_gid(CdrWriter& writer, const Guid& guid, GidSize size) {
  std::array<std::uint8_t, static_cast<std::size_t>(GidSize::kHumbleAndOlder)> bytes{};
  std::ranges::copy(guid.bytes, bytes.begin());
  writer.write_bytes(ByteView(bytes).first(static_cast<std::size_t>(size)));
}

void write_gids(CdrWriter& writer, const std::vector<Guid>& guids, GidSize size) {
  writer.write(static_cast<std::uint32_t>(guids.size()));
  for (const Guid& guid : guids) write_gid(writer, guid, size);
}

}  // namespace

GidSize gid_size_of(ByteView payload) {
  constexpr std::size_t kSmallestOld = kEncapsulationSize + 24 + sizeof(std::uint32_t);
  if (payload.size() < kSmallestOld) return GidSize::kIronAndNewer;
  const ByteView tail = payload.subspan(kEncapsulationSize + kGuidSize, 8);
  const bool zeros = std::ranges::all_of(tail, [](std::uint8_t b) { return b == 0; });
  return zeros ? GidSize::kHumbleAndOlder : GidSize::kIronAndNewer;
}

std::optional<DiscoveryInfo> decode_discovery_info(ByteView payload) {
  const GidSize size = gid_size_of(payload);
  CdrReader reader(payload);
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

Bytes encode_discovery_info(const DiscoveryInfo& info, GidSize size) {
  CdrWriter writer;
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
