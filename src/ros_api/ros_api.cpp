#include "ros_api/ros_api.h"

#include "base/invariant.h"

namespace culprit::ros_api {
namespace {

constexpr rtps::Qos kLatched{.durability = rtps::Durability::kTransientLocal, .depth = 1};
constexpr rtps::Qos kHistory{.depth = 100};

constexpr std::size_t place_of(Topic topic) { return static_cast<std::size_t>(topic); }

}  // namespace

RosApi::RosApi(Options options)
    : options_(std::move(options)),
      teller_(types_, options_.version,
              [this](Topic topic, const Json& message) { tell(topic, message); }) {
  told_[place_of(Topic::kStatus)].type = &types_.message("culprit_msgs/msg/Status");
  told_[place_of(Topic::kIncidents)].type = &types_.message("culprit_msgs/msg/Incident");
  told_[place_of(Topic::kDecisions)].type = &types_.message("culprit_msgs/msg/Decision");
  if (options_.give) orders_.emplace(types_, options_.give);
}

void RosApi::joined(ros2::NodeEntry& node) {
  std::vector<std::string> troubles;
  for (const Expected<void>& offered :
       {offer(node, Topic::kStatus, "~/status", kLatched),
        offer(node, Topic::kIncidents, "~/incidents", kHistory),
        offer(node, Topic::kDecisions, "~/decisions", kHistory), describe_types(node)}) {
    if (!offered) troubles.push_back(offered.error());
  }
  for (const std::string& trouble : recovery_.open(node)) troubles.push_back(trouble);
  if (orders_) {
    for (const std::string& trouble : orders_->open(node)) troubles.push_back(trouble);
  }
  if (troubles.empty()) return;
  std::string text = troubles[0];
  if (troubles.size() > 1)
    text += " (and " + std::to_string(troubles.size() - 1) + " more of culprit_msgs)";
  options_.on_trouble(text);
}

void RosApi::leaves() {
  if (orders_) orders_->close();
  recovery_.close();
  descriptions_.reset();
  for (Told& each : told_) each.publisher.reset();
}

Expected<void> RosApi::offer(ros2::NodeEntry& node, Topic topic, std::string_view name,
                             const rtps::Qos& qos) {
  Told& told = told_[place_of(topic)];
  auto publisher = ros2::RawPublisher::create(node, name, told.type->name, qos, told.type->hash);
  if (!publisher)
    return Error{"culprit does not publish " + std::string(name) + ": " + publisher.error()};
  told.publisher = std::move(*publisher);
  return {};
}

Expected<void> RosApi::describe_types(ros2::NodeEntry& node) {
  using Describe = ros2::srv::GetTypeDescription;
  const auto name = ros2::resolve_name("~/get_type_description", node.name());
  auto server = ros2::ServiceServer::create(
      node, {*name, std::string(Describe::kType)}, rtps::qos::kServices,
      [this](rtps::ByteView request) {
        const auto asked = rtps::decode<Describe::Request>(request);
        return asked ? rtps::encode(types_.described(*asked)) : rtps::Bytes();
      });
  if (!server) return Error{"types are not described by " + *name + ": " + server.error()};
  descriptions_ = std::move(*server);
  return {};
}

// If a message cannot be sent, the robot is healed without it.
void RosApi::tell(Topic topic, const Json& message) {
  if (topic == Topic::kStatus) recovery_.told(message);
  const Told& told = told_[place_of(topic)];
  if (!told.publisher) return;
  const auto payload = encode(message, *told.type);
  CULPRIT_ASSERT(payload);
  if (payload) (void)told.publisher->publish(*payload);
}

}  // namespace culprit::ros_api
