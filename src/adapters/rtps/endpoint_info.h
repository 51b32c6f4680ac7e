// A reader or writer of another participant, as it is discovered.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "rtps/guid.h"
#include "rtps/qos.h"

namespace culprit::rtps {

enum class EndpointRole : std::uint8_t { kReader, kWriter };

// Its announcement. DDS names; strings as sent, cut at 1024 bytes. History depth is not announced.
struct EndpointInfo {
  Guid guid;
  std::string topic;
  std::string type;
  std::string user_data;
  Qos qos;
  // Only endpoints with a common partition match (DDS 1.4 §2.2.3.13); none is the one that is
  // called "". ROS 2 has no partitions; XML profiles of the middleware have.
  std::vector<std::string> partitions{};
  bool operator==(const EndpointInfo&) const = default;
};

struct EndpointGone {
  Guid guid;
};

using EndpointNews = std::variant<EndpointInfo, EndpointGone>;

// Limits for a string, in bytes, and for partitions.
inline constexpr std::size_t kLongestSaid = 1024;
inline constexpr std::size_t kMostPartitions = 32;

}  // namespace culprit::rtps
