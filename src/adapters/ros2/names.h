// How ROS 2 names appear on DDS.
//
//     topic   /a/b             ->  rt/a/b           pkg/msg/Type  ->  pkg::msg::dds_::Type_
//     request of service /a/s  ->  rq/a/sRequest    pkg/srv/Type  ->  pkg::srv::dds_::Type_Request_
//     reply of service /a/s    ->  rr/a/sReply      pkg/srv/Type  -> pkg::srv::dds_::Type_Response_
//
// Every name from the network is untrusted. The demangling functions give nothing for a name that
// breaks the grammar of design.ros2.org/articles/topic_and_service_names.html, so their results are
// safe to print and to compare.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/expected.h"
#include "base/name_grammar.h"

namespace culprit::ros2 {

// The content of a DDS topic. Actions are made of these.
enum class Channel : std::uint8_t { kTopic, kRequest, kReply };

struct RosChannel {
  Channel channel;
  std::string name;  // of the topic or service, absolute
  bool operator==(const RosChannel&) const = default;
};

struct NodeName {
  std::string name_space = "/";  // "/" or "/a/b", no slash at the end
  std::string name;

  std::string full() const { return name_space == "/" ? "/" + name : name_space + "/" + name; }
  bool operator==(const NodeName&) const = default;
};

// "/a/b/node" -> {"/a/b", "node"}.
Expected<NodeName> parse_node_name(std::string_view full_name);

// Resolves a topic or service name as a node does: "/x" as it is, "x" below its namespace, "~/x"
// below itself.
Expected<std::string> resolve_name(std::string_view name, const NodeName& node);

// @pre is_valid_topic_name(name), is_valid_type_name(type)
std::string mangle_topic(Channel channel, std::string_view name);
std::string mangle_type(Channel channel, std::string_view type);

std::optional<RosChannel> demangle_topic(std::string_view dds_topic);
std::optional<std::string> demangle_type(Channel channel, std::string_view dds_type);

}  // namespace culprit::ros2
