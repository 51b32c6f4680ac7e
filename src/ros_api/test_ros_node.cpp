#include "ros_api/test_ros_node.h"

namespace culprit::ros_api {

rtps::EventLog<Json>& TestRosNode::hear(const std::string& topic, const std::string& type,
                                        rtps::Durability durability) {
  auto& log = *logs_.emplace_back(std::make_unique<rtps::EventLog<Json>>());
  auto subscription =
      ros2::Subscription::create(node_, topic, type, {.durability = durability, .depth = 100},
                                 [this, &log, type](rtps::ByteView payload) {
                                   const auto message = decode(payload, types.message(type));
                                   if (message) {
                                     log.add(*message);
                                   } else {
                                     ADD_FAILURE() << message.error();
                                   }
                                 });
  if (!subscription) throw std::runtime_error(subscription.error());
  subscriptions_.push_back(std::move(*subscription));
  return log;
}

// Discovery data comes in order: a node that answers a client has discovered all that was made
// before it.
bool TestRosNode::is_known_to(const std::string& node) {
  const auto client = ros2::ServiceClient::create(
      node_, {node + "/get_type_description", std::string(ros2::srv::GetTypeDescription::kType)});
  if (!client) throw std::runtime_error(client.error());
  rtps::EventLog<bool> answers;
  (*client)->call(rtps::encode(ros2::srv::GetTypeDescription::Request{}),
                  ros2::Repeat::kUntilAnswered, rtps::kPatience,
                  [&](const ros2::CallResult& result) {
                    answers.add(result.outcome == ros2::CallOutcome::kAnswered);
                  });
  return answers.wait_for_count(1) && answers.all()[0];
}

Json TestRosNode::call(const std::string& service, const std::string& type, const Json& request,
                       Duration patience) {
  const auto payload = encode(request, types.service(type).request);
  if (!payload) throw std::runtime_error(payload.error());
  return call_with(service, type, *payload, patience);
}

Json TestRosNode::call_with(const std::string& service, const std::string& type,
                            const rtps::Bytes& request, Duration patience) {
  const auto client = client_of(service, type);
  rtps::EventLog<rtps::Bytes> answers;
  client->call(request, ros2::Repeat::kNever, patience, [&](const ros2::CallResult& result) {
    answers.add({result.reply.begin(), result.reply.end()});
  });
  if (!answers.wait_for_count(1) || answers.all()[0].empty()) return nullptr;
  const auto read = decode(answers.all()[0], types.service(type).response);
  return read ? *read : Json(read.error());
}

std::unique_ptr<ros2::ServiceClient> TestRosNode::client_of(const std::string& service,
                                                            const std::string& type) {
  const std::string node = service.substr(0, service.find('/', 1));
  auto client = ros2::ServiceClient::create(
      node_, {service, type}, rtps::qos::kServices,
      {{node + "/get_type_description", std::string(ros2::srv::GetTypeDescription::kType)},
       rtps::encode(ros2::srv::GetTypeDescription::Request{})});
  if (!client) throw std::runtime_error(client.error());
  return std::move(*client);
}

}  // namespace culprit::ros_api
