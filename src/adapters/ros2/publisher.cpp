#include "ros2/publisher.h"

#include "ros2/type_description.h"

namespace culprit::ros2 {

Expected<std::unique_ptr<RawPublisher>> RawPublisher::create(NodeEntry& node,
                                                             std::string_view topic,
                                                             std::string_view type,
                                                             const rtps::Qos& qos,
                                                             std::string_view type_hash) {
  const auto name = resolve_name(topic, node.name());
  if (!name) return Error{name.error()};
  if (!is_valid_type_name(type))
    return Error{"'" + printable(type) + "' is not the name of a type"};
  auto writer =
      node.context().participant().create_writer({.topic = mangle_topic(Channel::kTopic, *name),
                                                  .type = mangle_type(Channel::kTopic, type),
                                                  .qos = qos,
                                                  .user_data = type_user_data(type_hash),
                                                  .on_match = {}});
  if (!writer) return Error{writer.error()};
  return std::make_unique<RawPublisher>(node, std::move(*writer));
}

RawPublisher::RawPublisher(NodeEntry& node, std::unique_ptr<Writer> writer)
    : node_(node), writer_(std::move(writer)) {
  node_.add(writer_->guid());
}

RawPublisher::~RawPublisher() { node_.remove(writer_->guid()); }

}  // namespace culprit::ros2
