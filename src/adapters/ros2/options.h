// How a participant joins: which domain, its reach, and its announcement. The environment variables
// are those that the robot's own nodes obey, so that culprit started in the same shell meets the
// same robot.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/expected.h"
#include "ros2/discovery_info.h"
#include "ros2/security.h"
#include "rtps/endpoint_info.h"

namespace culprit::ros2 {

enum class Reach : std::uint8_t { kLocalhost, kSubnet };

// A server that nodes on Fast DDS find one another through, in place of multicast.
struct DiscoveryServer {
  std::uint8_t id = 0;  // its place in ROS_DISCOVERY_SERVER; its identity follows from it
  std::string host;     // an IPv4 address or a name
  std::uint16_t port = 0;
  bool operator==(const DiscoveryServer&) const = default;
};

struct HelperOptions;

struct ParticipantOptions {
  std::uint32_t domain = 0;  // 0..232; above 101 the ports collide with those that Linux hands out
  Reach reach = Reach::kSubnet;
  std::string enclave = "/";
  std::vector<std::string>
      peers;  // further IPv4 addresses or host names to announce to, where multicast does not reach
  // Called for each peer whose name cannot be resolved, with the reason, before the participant is made without it. Empty:
  // that is an error.
  std::function<void(const std::string& why)> on_missing_peer{};
  // Not empty: everything that these know is discovered (a super client), and nothing else.
  std::vector<DiscoveryServer> servers{};
  // The form in which ros_discovery_info is written. Nothing: the form of the first peer.
  std::optional<GidSize> gid_size;
  // The size of the UDP sockets' buffers. The system's default of 208 kB loses large best effort
  // samples; net.core.rmem_max caps it.
  std::uint32_t socket_buffer_bytes = 4 * 1024 * 1024;
  std::optional<Security> security{};  // nothing: in the clear
  // Whether this participant never matches others' readers, or writers, of a topic (DDS name), for
  // it never writes, or reads, there: creating such an endpoint is refused. They are discovered all
  // the same, but are kept from the middleware, which saves most of the cost of discovering a large
  // robot. Without effect in a secured domain and through servers. Called from any thread. Empty:
  // it may match all.
  std::function<bool(std::string_view topic, rtps::EndpointRole role)> never_meets{};
  // Not null: the participant speaks through this helper program (helper_options.h), over the robot's own middleware, and the
  // options above but for the domain are without effect. Null: over DDS.
  std::shared_ptr<const HelperOptions> helper{};
};

// The value of a variable, or null.
using Environment = std::function<const char*(const char* name)>;

// ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS,
// ROS_DISCOVERY_SERVER, and those of security.h. An error names the variable.
Expected<ParticipantOptions> options_from_environment(const Environment& get);
Expected<ParticipantOptions> options_from_environment();

// The IPv4 address of a host, in dots. Asks the resolver for names.
Expected<std::string> resolve_peer(const std::string& host);

}  // namespace culprit::ros2
