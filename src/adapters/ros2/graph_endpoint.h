// The meaning of a DDS endpoint in ROS 2: which topic or service it offers or uses.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/endpoint_kind.h"
#include "ros2/participant.h"

namespace culprit::ros2 {

struct GraphEndpoint {
  EndpointKind kind = EndpointKind::kPublisher;
  std::string name;  // of the topic or service, absolute
  std::string type;  // "package/msg/Type" or "package/srv/Type"
  rtps::Qos qos;     // as announced, without depth
  // As announced (type_description.h); empty before Iron. Of a service: of its request.
  std::string type_hash{};
  std::string service_hash{};  // likewise of the whole service; empty before Lyrical
  std::vector<std::string> partitions{};
  // Of services: it names its other half ("clientid=", "serviceid="), as rmw_cyclonedds does, and
  // others that use its mapping (service_mapping.h).
  bool names_its_pair = false;
};

// A node's reader of a topic is a subscriber, its reader of requests a server, and so on. Nothing: it is no endpoint of
// ROS 2, or the other half of a service (replies), which adds nothing.
std::optional<GraphEndpoint> ros_meaning(const rtps::EndpointInfo& info);

}  // namespace culprit::ros2
