#include "ros2/names.h"

#include "base/invariant.h"

namespace culprit::ros2 {
namespace {

constexpr std::string_view kDdsModule = "::dds_::";

struct Mangling {
  std::string_view prefix;
  std::string_view topic_suffix;
  std::string_view type_suffix;
};

constexpr Mangling mangling(Channel channel) {
  switch (channel) {
    case Channel::kTopic:
      return {"rt", "", "_"};
    case Channel::kRequest:
      return {"rq", "Request", "_Request_"};
    case Channel::kReply:
      return {"rr", "Reply", "_Response_"};
  }
  return {};
}

}  // namespace

Expected<NodeName> parse_node_name(std::string_view full_name) {
  const auto slash = full_name.rfind('/');
  if (slash != std::string_view::npos) {
    NodeName node{std::string(slash == 0 ? "/" : full_name.substr(0, slash)),
                  std::string(full_name.substr(slash + 1))};
    const bool is_valid = is_valid_namespace(node.name_space) && is_valid_node_name(node.name);
    if (is_valid && node.full() == full_name) return node;
  }
  return Error{"'" + printable(full_name) +
               "' is not the full name of a node, as in /namespace/node"};
}

Expected<std::string> resolve_name(std::string_view name, const NodeName& node) {
  std::string absolute;
  if (name.starts_with('/')) {
    absolute = name;
  } else if (name.starts_with('~')) {
    absolute = node.full() + std::string(name.substr(1));
  } else {
    absolute = (node.name_space == "/" ? "/" : node.name_space + "/") + std::string(name);
  }
  if (is_valid_topic_name(absolute)) return absolute;
  return Error{"'" + printable(name) + "' is not the name of a topic or service"};
}

std::string mangle_topic(Channel channel, std::string_view name) {
  CULPRIT_ASSERT(is_valid_topic_name(name));
  const Mangling m = mangling(channel);
  return std::string(m.prefix).append(name).append(m.topic_suffix);
}

std::string mangle_type(Channel channel, std::string_view type) {
  CULPRIT_ASSERT(is_valid_type_name(type));
  const auto first = type.find('/');
  const auto last = type.rfind('/');
  return std::string(type.substr(0, first))
      .append("::")
      .append(type.substr(first + 1, last - first - 1))
      .append(kDdsModule)
      .append(type.substr(last + 1))
      .append(mangling(channel).type_suffix);
}

std::optional<RosChannel> demangle_topic(std::string_view dds_topic) {
  for (const Channel channel : {Channel::kTopic, Channel::kRequest, Channel::kReply}) {
    const Mangling m = mangling(channel);
    if (!dds_topic.starts_with(m.prefix) || !dds_topic.ends_with(m.topic_suffix)) continue;
    if (dds_topic.size() < m.prefix.size() + m.topic_suffix.size()) continue;
    const auto name = dds_topic.substr(m.prefix.size(),
                                       dds_topic.size() - m.prefix.size() - m.topic_suffix.size());
    if (is_valid_topic_name(name)) return RosChannel{channel, std::string(name)};
  }
  return std::nullopt;
}

std::optional<std::string> demangle_type(Channel channel, std::string_view dds_type) {
  const auto suffix = mangling(channel).type_suffix;
  const auto kind = dds_type.find("::");
  const auto module = dds_type.find(kDdsModule);
  if (module == std::string_view::npos || kind >= module || !dds_type.ends_with(suffix)) {
    return std::nullopt;
  }
  const auto name = module + kDdsModule.size();
  if (dds_type.size() < name + suffix.size()) return std::nullopt;
  std::string type(dds_type.substr(0, kind));
  type.append("/")
      .append(dds_type.substr(kind + 2, module - kind - 2))
      .append("/")
      .append(dds_type.substr(name, dds_type.size() - name - suffix.size()));
  if (!is_valid_type_name(type)) return std::nullopt;
  return type;
}

}  // namespace culprit::ros2
