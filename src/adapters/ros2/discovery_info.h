// rmw_dds_common/msg/ParticipantEntitiesInfo: a participant's announcement of its nodes and their
// endpoints, on the topic `ros_discovery_info`. Each message replaces everything known about that
// participant.
//
// The one type that is not wire-identical everywhere: up to Humble a gid takes 24 bytes (16 of
// GUID, 8 of zeros), from Iron on 16. Both have the same type name, so a reader must distinguish
// them by the bytes, and a writer must know the size that its peers use: the wrong size makes them
// print an error and not list our nodes.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rtps/cdr.h"
#include "rtps/guid.h"

namespace culprit::ros2 {

inline constexpr std::string_view kDiscoveryInfoTopic = "ros_discovery_info";
inline constexpr std::string_view kDiscoveryInfoType =
    "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_";

enum class GidSize : std::uint8_t { kIronAndNewer = 16, kHumbleAndOlder = 24 };

// Names are as sent, not validated.
struct NodeEntities {
  std::string name_space;
  std::string name;
  std::vector<rtps::Guid> readers;
  std::vector<rtps::Guid> writers;
  bool operator==(const NodeEntities&) const = default;
};

struct DiscoveryInfo {
  rtps::Guid participant;
  std::vector<NodeEntities> nodes;
  bool operator==(const DiscoveryInfo&) const = default;
};

// With 16 bytes, bytes 16..23 of the body hold the (non-zero) number of nodes; with 24, the zeros
// of the first gid.
GidSize gid_size_of(rtps::ByteView payload);

std::optional<DiscoveryInfo> decode_discovery_info(rtps::ByteView payload);

rtps::Bytes encode_discovery_info(const DiscoveryInfo& info, GidSize size);

}  // namespace culprit::ros2
