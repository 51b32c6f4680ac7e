#include "ros2/graph_endpoint.h"

#include <utility>

#include "ros2/names.h"
#include "ros2/service_mapping.h"

namespace culprit::ros2 {

std::optional<GraphEndpoint> ros_meaning(const rtps::EndpointInfo& info) {
  auto channel = demangle_topic(info.topic);
  if (!channel || channel->channel == Channel::kReply) return std::nullopt;
  auto type = demangle_type(channel->channel, info.type);
  if (!type) return std::nullopt;
  const bool reads = info.guid.is_reader();
  EndpointKind kind = reads ? EndpointKind::kSubscriber : EndpointKind::kPublisher;
  if (channel->channel == Channel::kRequest)
    kind = reads ? EndpointKind::kServer : EndpointKind::kClient;
  return GraphEndpoint{kind,
                       std::move(channel->name),
                       std::move(*type),
                       info.qos,
                       std::string(user_data_value(info.user_data, "typehash")),
                       std::string(user_data_value(info.user_data, "sertypehash")),
                       info.partitions,
                       !user_data_value(info.user_data, "clientid").empty() ||
                           !user_data_value(info.user_data, "serviceid").empty()};
}

}  // namespace culprit::ros2
